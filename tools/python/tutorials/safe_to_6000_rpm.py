"""Is my rod safe up to 6000 rpm? A sweep locates resonances and unstable bands; a map says what would help.

    python3 safe_to_6000_rpm.py [FOLDER]
"""

import pathlib
import sys

import matplotlib.pyplot as plt

import hb

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
slim = {
    "title": "Four-bar with a slim coupler",
    "units": {"length": "mm"},
    "crank": {"pivot": [0, 0], "length": 40},
    "dyad": [
        {
            "on": "crank",
            "coupler": {
                "name": "coupler",
                "length": 250,
                "mass": 0.08,
                "elastic": {"E": "210 GPa", "area": 40, "J": 60, "damping_internal": 2e-5},
            },
            "rocker": {"name": "rocker", "pivot": [240, 0], "length": 120, "mass": 0.5, "com": [60, 0], "inertia": 900},
            "branch": -1,
        }
    ],
}
m = hb.Scene.from_dict(slim)

# Unstable bands are located between the speeds too; every verdict rests on an error bar.
sw = m.sweep(rpm=(500, 6000, 125), modes=3, only=["steady", "stability"], threads=2)
rod = sw["coupler"]
print(f"{len(rod.unstable_bands or [])} unstable bands up to 6000 rpm")
for band in rod.band_details:
    print(f"  {band['from']:.1f} to {band['to']:.1f} rpm, growth up to {band['fastest_growth']:.3g} 1/s")
strongest = sorted(sw.critical, key=lambda peak: -peak.prominence)[:5]
for peak in strongest:
    size = "without bound" if peak.unbounded else f"{peak.max_abs:.4g} mm"
    print(f"  resonance at {peak.rpm:.1f} rpm: max |q_{peak.q}| {size}")

# Would more damping help? Growth rate over speed and internal damping; None is interpolated into a verdict.
mp = m.map(x="rpm=3000:6000:21", y="coupler.damping_internal=1e-6:5e-5:11", modes=3, threads=2)
unstable = (mp.verdict == "unstable").mean()
print(f"{100 * unstable:.0f} % of the map is unstable, {len(mp.boundaries)} boundary curves")

fig, axes = plt.subplots(3, 1, figsize=(9, 13), layout="constrained")
rod.plot("campbell", ax=axes[0])
rod.plot("peaks", ax=axes[1])
mp.plot(ax=axes[2])
fig.savefig(folder / "safe_to_6000_rpm.png", dpi=100)
