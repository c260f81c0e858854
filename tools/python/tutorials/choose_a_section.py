"""Choose a section: the lightest rectangular rod that stays stiff and stable over a range of speeds.

    python3 choose_a_section.py [FOLDER]
"""

import pathlib
import sys

import matplotlib.pyplot as plt

import hb

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
m = hb.Scene.from_dict(
    {
        "title": "Slider-crank with a flat rod",
        "units": {"length": "mm"},
        "crank": {"pivot": [0, 0], "length": 40},
        "dyad": [
            {
                "on": "crank",
                "coupler": {
                    "name": "rod",
                    "length": 200,
                    "elastic": {
                        "material": "steel",
                        "section": {"shape": "rectangle", "width": 8, "height": 20},
                        "damping_internal": 2e-5,
                    },
                },
                "slider": {"name": "piston", "mass": 0.4, "guide": [0, 0], "direction": 0},
                "branch": 1,
            }
        ],
    }
)

# Worst over all speeds of the range, found between those sampled.
t = m.tune(
    minimise="mass",
    vary={"rod.section.height": (5, 30)},
    keep=["deflection<=0.05", "stable>=5"],
    over=(500, 2500),
    modes=2,
)
print(t)
print(f"height {t.values['rod.section.height']:.4g} mm, verified: {t.verified}")
assert t.scene["rod.section.height"] == t.values["rod.section.height"]

before = m.sweep(rpm=(500, 2500, 50), modes=2, only="steady,shape")
after = t.scene.sweep(rpm=(500, 2500, 50), modes=2, only="steady,shape")
fig, axes = plt.subplots(2, 1, figsize=(8, 8), layout="constrained")
axes[0].plot(before.x, before["rod"].deflection, "--", color="#d55e00", label="before")
axes[0].plot(after.x, after["rod"].deflection, color="#0072b2", label="after")
axes[0].axhline(0.05, color="#000000", linewidth=0.8)
axes[0].set(xlabel="crank speed [rpm]", ylabel="largest deflection [mm]", title="Allowed: 0.05 mm")
axes[0].legend(frameon=False)
t.plot(ax=axes[1])
fig.savefig(folder / "choose_a_section.png", dpi=100)
