"""My own Hill system: the stability chart of Mathieu's equation beside SciPy's characteristic values.

    x'' + (a - 2 q cos 2t) x = 0,   in tau = Omega t with Omega = 2: stiffness a - 2 q cos(tau)

    python3 mathieu_chart.py [FOLDER]
"""

import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import mathieu_a, mathieu_b

import hb

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")


def mathieu(a, q, damping=0.0):
    return hb.HillSystem(mass=1, damping=damping, stiffness={0: a, 1: -2 * q})


# The growth rate at one place has an error, which the verdict rests on.
s = mathieu(1.0, 0.5).stability(omega=2)
print(f"a = 1, q = 0.5: {s.verdict}, growth rate {s.growth_rate:.10f} +/- {s.growth_error:.1e}")

# Every place of the chart is one call.
a, q = np.linspace(0.02, 8, 81), np.linspace(0.02, 5, 51)
growth = np.array([[mathieu(x, y).stability(omega=2).growth_rate for x in a] for y in q])

# The boundaries are known: the characteristic values a_r(q), b_r(q).
curves = {f"$a_{r}$": mathieu_a(r, q) for r in range(4)} | {f"$b_{r}$": mathieu_b(r, q) for r in range(1, 4)}

# Undamped, the verdict changes exactly there: bounded on one side, unstable on the other.
wrong = 0
for y in (0.5, 2.0, 4.0):
    for r in range(1, 3):
        for value, inside in ((mathieu_b(r, y), 1), (mathieu_a(r, y), -1)):
            for side in (-1, 1):
                expected = "unstable" if side == inside else "bounded"
                wrong += mathieu(value + side * 1e-6, y).stability(omega=2).verdict != expected
print(f"{wrong} of 24 verdicts a millionth beside SciPy's curves differ from them")
assert wrong == 0

# The boundaries of a map, refined to their tolerance, lie on the curves too.
system = mathieu(1.0, 0.5, damping=1e-9).to_scene("Mathieu")
mp = system.map(x="hill.stiffness.0.cos.0.0=0.2:2:19", y="hill.stiffness.1.cos.0.0=-2:-0.2:10", omega=2)
worst = 0.0
for boundary in mp.boundaries:
    for x, y in boundary.points:
        near = [mathieu_b(1, -y / 2), mathieu_a(1, -y / 2), mathieu_a(0, -y / 2), mathieu_b(2, -y / 2)]
        worst = max(worst, min(abs(x - value) for value in near))
print(f"{len(mp.boundaries)} boundaries of the map, at most {worst:.1e} away from SciPy's")
assert worst < 1e-6

fig, ax = plt.subplots(figsize=(9, 5.5), layout="constrained")
shown = ax.pcolormesh(a, q, np.where(growth > 1e-9, growth, np.nan), cmap="Reds", vmin=0, shading="nearest")
fig.colorbar(shown, ax=ax, label="growth rate (white: bounded)")
for name, values in curves.items():
    ax.plot(values, q, color="#0072b2" if name.startswith("$a") else "#000000", linewidth=1.4)
    place = np.flatnonzero((values > 0) & (values < 8))
    if len(place):
        ax.annotate(name, (values[place[-1]], q[place[-1]]), xytext=(2, -10), textcoords="offset points")
ax.set(xlim=(a[0], a[-1]), ylim=(q[0], q[-1]), xlabel="a", ylabel="q")
ax.set_title("Mathieu's equation: growth rate by hb, curves: SciPy's characteristic values", fontsize=10)
fig.savefig(folder / "mathieu_chart.png", dpi=100)
