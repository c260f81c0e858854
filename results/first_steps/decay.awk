# A free vibration as a sensor would give it: mode 1 of the rod at 206 Hz with 1 % of damping, noise of 2 %.
BEGIN {
  print "time [ms],acceleration"
  pi = atan2(0, -1); omega = 2 * pi * 206; zeta = 0.01; seed = 1
  for (k = 0; k <= 400; ++k) {
    t = 1e-4 * k
    seed = (16807 * seed) % 2147483647  # Lehmer's generator: the same on every machine
    noise = 0.04 * (seed / 2147483647 - 0.5)
    printf "%.1f,%.6f\n", 1000 * t, exp(-zeta * omega * t) * cos(omega * sqrt(1 - zeta * zeta) * t) + noise
  }
}
