"""Smallest processor time of each benchmark, with its error beside it: hb_benchmarks' JSON in, CSV out."""
import json
import sys

rows = {}
document = json.load(sys.stdin)
for run in document["benchmarks"]:
    if run.get("run_type") != "iteration":
        continue
    milliseconds = run["cpu_time"] * {"us": 1e-3, "ms": 1}[run["time_unit"]]
    if run["name"] not in rows or milliseconds < rows[run["name"]][0]:
        rows[run["name"]] = (milliseconds, run)
print("# one thread, smallest of several runs; error: of the theory error, of the motion (relative)")
print("benchmark,milliseconds,error,error bound,harmonics,points")
for name, (milliseconds, run) in rows.items():
    numbers = [run.get(key) for key in ("error", "bound", "harmonics", "points")]
    print(name.split("/iterations")[0], f"{milliseconds:.3g}", *("" if n is None else f"{n:.3g}" for n in numbers), sep=",")
