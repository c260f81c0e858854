#!/usr/bin/env python3
"""table.csv from what the attacks printed: one row for each attack and family, runs of several seeds added up."""
import csv
import pathlib
import re

here = pathlib.Path(__file__).parent
# Column of the printed table -> column here. "wrong" stands three times in the table of maps.
COLUMNS = {
    "exponents": ["cases", "exponents", "uncovered", "missing", "infinite", "undecided", "wrong", "median", "q90",
                  "allowed", "slowest_s"],
    "sweeps": ["lines", "sweeps", "bands", "gaps", "missed", "listed", "false", "ends", "beyond", "verdicts",
               "not_excluded_percent", "slowest_s"],
    "maps": ["maps", "unfinished", "nodes", "wrong_nodes", "curves", "curve_points", "wrong_curve_points", "edge_places",
             "wrong_edges", "inner_places", "wrong_inner", "listed", "undecided", "slowest_s"],
}
SIZE = {"exponents": "exponents", "sweeps": "sweeps", "maps": "maps"}  # weight of medians and shares
MEAN = {"median", "q90", "not_excluded_percent"}
LARGEST = {"slowest_s", "allowed"}


def rows(part):
    """Family -> list of rows of numbers, one for each seed; of exponents those of the automatic method."""
    found = {}
    counts = True
    for line in (here / f"{part}.txt").read_text().splitlines():
        if title := re.match(r"(automatic|slaving|propagation|hill|determinant)(, leading.*)?, seed", line):
            counts = title[1] == "automatic" and not title[2]
        if not counts:
            continue
        words = re.sub(r" (%|ms|s)(?= |$)", r"\1", line).split()
        if len(words) != len(COLUMNS[part]) + 1 or words[0] in ("family", "all"):
            continue
        values = {}
        for name, word in zip(COLUMNS[part], words[1:]):
            number = float(re.sub(r"(%|ms|s)$", "", word))
            values[name] = number / 1000 if word.endswith("ms") else number
        found.setdefault(words[0], []).append(values)
    return found


def added(part, runs):
    total = {}
    for name in COLUMNS[part]:
        values = [run[name] for run in runs]
        if name in MEAN:
            weights = [run[SIZE[part]] for run in runs]
            total[name] = sum(v * w for v, w in zip(values, weights)) / max(sum(weights), 1)
        else:
            total[name] = max(values) if name in LARGEST else sum(values)
    return total


with open(here / "table.csv", "w", newline="") as file:
    out = csv.writer(file, lineterminator="\n")
    out.writerow(["attack", "family", "quantity", "value"])
    for part in COLUMNS:
        if not (here / f"{part}.txt").exists():
            continue
        for family, runs in rows(part).items():
            for name, value in added(part, runs).items():
                out.writerow([part, family, name, f"{value:.4g}" if value != int(value) else int(value)])
