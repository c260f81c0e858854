"""Per rod max over i, t of |q_nonlinear - q_linear| / max |q_linear|, beside the theory error of the linear answer."""
import cmath
import glob
import json
import math
import os
import sys

folder = sys.argv[1]


def values(fourier, samples=512):
    """q_i at equally spaced crank angles."""
    turn = 2 * math.pi / samples
    rows = []
    for c in fourier:
        c = [complex(re, im) for re, im in c]
        rows.append([c[0].real + 2 * sum((c[n] * cmath.exp(1j * n * turn * j)).real for n in range(1, len(c)))
                     for j in range(samples)])
    return rows


def largest(rows):
    return max(abs(v) for row in rows for v in row)


print("# first correction and true change of q over max |q|, I = 1; -: no value")
print("rpm,AB theory error,AB true change,CD theory error,CD true change")
for path in sorted(glob.glob(os.path.join(folder, "linear_*.json")), key=lambda p: float(p.split("_")[-1][:-5])):
    rpm = path.split("_")[-1][:-5]
    linear = json.load(open(path))
    nonlinear = json.load(open(path.replace("linear_", "nonlinear_")))
    cells = [rpm]
    for rod in ("AB", "CD"):
        error = linear["rods"][rod]["theory_error"]
        cells.append("-" if error is None else f"{error:.6e}")
        if nonlinear.get("found") is None or rod not in nonlinear["rods"]:
            cells.append("-")
            continue
        a, b = values(linear["rods"][rod]["q"]["fourier"]), values(nonlinear["rods"][rod]["q"]["fourier"])
        change = [[x - y for x, y in zip(p, q)] for p, q in zip(b, a)]
        cells.append(f"{largest(change) / largest(a):.6e}")
    print(",".join(cells))
