"""What shear changes of the thick rod at 9000 rpm: deflection, moment, growth rate, frequencies at rest."""
import json
import os
import sys

folder = sys.argv[1]
none = json.load(open(os.path.join(folder, "shear_none.json")))["rods"]["rod"]
print("# relative to the rod without shear: I = 5, 9000 rpm, gas force; frequencies at rest in Hz")
print("k,deflection [m],change,bending moment [N m],change,growth rate [1/s],change,theory error,"
      "f1,f2,f3")
for k in ("none", "0.8333333333333334", "0.45"):
    rod = json.load(open(os.path.join(folder, f"shear_{k}.json")))["rods"]["rod"]
    cells = [k[:6]]
    for value in (lambda r: r["deflection"]["max_abs"], lambda r: r["bending_moment"]["max_abs"],
                  lambda r: r["growth_rate"]):
        cells += [f"{value(rod):.7g}", f"{value(rod) / value(none) - 1:.4f}"]
    cells.append(f"{rod['theory_error']:.3g}")
    scene = os.path.join(folder, f"scene_{k}.json")
    if os.path.exists(scene):
        coupler = json.load(open(scene))["linkage"]["dyads"][0]["coupler"]
        cells += [f"{f:.6g}" for f in coupler["natural_frequencies_hz"]]
    print(",".join(cells))
