# distance.awk map_boundaries.csv mathieu_characteristic.csv: how far the boundaries are from the characteristic values
# a_n(q), b_n(q) along the rows 2q of the map.
BEGIN { FS = ","; from = -5; to = 20 }
/^#/ || $1 !~ /^(a|b|[0-9.]+)$/ { next }
NR == FNR { x[++n] = $4; y[n] = $5; next }
$5 > from && $5 < to {
  nearest = 1e300
  for (k = 1; k <= n; ++k) {
    d = x[k] - $5
    if (d < 0) d = -d
    if (y[k] - 2 * $3 < 1e-9 && 2 * $3 - y[k] < 1e-9 && d < nearest) nearest = d
  }
  ++compared
  if (nearest > worst) { worst = nearest; where = $1 $2 "(" $3 + 0 ")" }
}
END { printf "%d characteristic values compared, largest distance %.2g, of %s\n", compared, worst, where }
