"""My first slider-crank: how far does the connecting rod bend, and what does that do to the bearings?

    python3 first_slider_crank.py [FOLDER]      pictures go into FOLDER, default .
"""

import pathlib
import sys

import matplotlib.pyplot as plt
import numpy as np

import hb

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")

# A scene is a dict of the keys that a scene file has; hb.load("scene.toml") reads one from a file.
m = hb.Scene.from_dict(
    {
        "title": "My first slider-crank",
        "units": {"length": "mm", "mass": "kg", "time": "s", "angle": "deg"},
        "crank": {"pivot": [0, 0], "length": 40, "mass": 1.2, "com": [8, 180]},
        "dyad": [
            {
                "on": "crank",
                "coupler": {
                    "name": "rod",
                    "length": 150,
                    "elastic": {
                        "material": "steel",
                        "section": {"shape": "rectangle", "width": 20, "height": 8},
                        "damping_internal": 2e-5,
                    },
                },
                "slider": {"name": "piston", "mass": 0.4, "guide": [0, 0], "direction": 0},
                "branch": 1,
            }
        ],
    }
)
print(m)

# One speed. Everything is in the scene's units: here mm, and forces in kg mm/s^2 = mN.
s = m.steady(rpm=3000, modes=4)
rod = s["rod"]
print(f"{rod.verdict}: growth rate {rod.growth_rate:.4g} +/- {rod.growth_error:.1e} 1/s")
print(f"largest |q_1| {rod.max_abs[0]:.6g} mm, error bound {rod.error_bound:.1e} of it")
print(f"the linear theory itself is off by {rod.theory_error:.1e}")

# The deflection at every place and crank angle.
x, angle = np.linspace(0, 150, 61), np.linspace(0, 360, 361)
w = rod.deflection(x, angle)
j, k = np.unravel_index(np.abs(w).argmax(), w.shape)
print(f"largest deflection {abs(w[j, k]):.5g} mm at x = {x[j]:g} mm, crank angle {angle[k]:g} deg")

# Bearings: elastic beside rigid.
crank_pin = s.joints["rod.0"]
difference = np.abs(crank_pin.elastic(angle) - crank_pin.rigid(angle)).max() / 1000
print(f"elasticity changes the force at the crank pin by up to {difference:.3g} N")

# A changed copy: a rod as high as 10 mm.
stiff = m.with_({"rod.section.height": 10}).steady(rpm=3000, modes=4)["rod"]
print(f"10 instead of 8 mm high: {stiff.max_abs[0] / rod.max_abs[0]:.3f} of the deflection")

fig, axes = plt.subplots(2, 2, figsize=(12, 8.5), layout="constrained")
m.plot(ax=axes[0, 0])
rod.plot("response", ax=axes[0, 1])
rod.plot("deflection", ax=axes[1, 0])
s.plot(kind="torque", ax=axes[1, 1])
fig.savefig(folder / "first_slider_crank.png", dpi=100)
