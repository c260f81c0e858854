# Gas force on the piston over one turn of a two-stroke engine, every degree of crank angle from top dead centre:
# closed cycle p (V/V_trapped)^1.3 with a smooth combustion factor, opened to the atmosphere by smooth ports.
function step(x) { return 1 / (1 + exp(-x)) }

BEGIN {
  pi = atan2(0, -1)
  r = 0.027; l = 0.11; bore = 0.054
  ambient = 1.0e5; trapped = 1.1e5; n = 1.3
  compression = 7; port = 93        # trapped compression ratio; crank angle at which the ports open, deg
  rise = 3.6                        # pressure after combustion over pressure before, at equal volume
  area = pi * bore * bore / 4
  clearance = travel(port * pi / 180) / (compression - 1)

  print "crank_angle,force"
  for (degree = 0; degree < 360; degree++) {
    before = degree > 180 ? degree - 360 : degree            # -180 < before <= 180
    s = travel(degree * pi / 180)
    closed = trapped * ((compression * clearance) / (clearance + s)) ^ n * (1 + (rise - 1) * step((before - 7) / 3))
    shut = step((port - before) / 4) * step((port + before) / 4)
    force = -area * shut * (closed - ambient)
    printf "%d,%.6f\n", degree, force < -5e-7 ? force : 0
  }
}

# Piston travel from top dead centre.
function travel(tau) { return r * (1 - cos(tau)) + l - sqrt(l * l - r * r * sin(tau) ^ 2) }
