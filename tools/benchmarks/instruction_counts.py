"""Instructions that small commands take, counted by valgrind, against those on record: python3 instruction_counts.py HB
[--record] -- COMPILER [FLAG...]. Fails where a command takes over 10 % more than on record; --record writes what was counted.

Unlike seconds the count does not depend on what else the machine does. It does on compiler and instruction set, which the
compiler names: results/benchmarks/instruction_counts.csv has a row for each command and build. Exit status 77 (skipped)
where this build is not on record, valgrind is not installed, or it does not know the build's instructions."""

import argparse
import csv
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

root = pathlib.Path(__file__).resolve().parent.parent.parent
RECORD = root / "results" / "benchmarks" / "instruction_counts.csv"
MARGIN = 0.1
COMMANDS = (
    "steady results/six_link/scene.toml --rpm 1000 --json",
    "sweep results/six_link/scene.toml --rpm 600:800:100 --json --threads 1",
)


def counted(hb, line):
    """Instructions of one run; None where valgrind does not know one of them."""
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", hb, *line.split()], cwd=root,
                             stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                             env={"PATH": "/usr/bin:/bin", "HOME": folder, "LC_ALL": "C"})
    if run.returncode < 0 and "unhandled instruction" in run.stderr:
        return None
    if run.returncode not in (0, 3):
        raise SystemExit(f"hb {line}: exit status {run.returncode}\n{run.stderr}")
    return int(re.search(r"Collected : (\d+)", run.stderr)[1])


def build_of(compiler):
    """Version, vector instructions and the machine that was tuned for, as in `GNU 12.2.0, AVX2 FMA, for znver3`."""
    said = subprocess.run([*compiler, "-dM", "-E", "-x", "c++", "/dev/null"], capture_output=True, text=True, check=True).stdout
    macros = dict(line.split(maxsplit=2)[1:] for line in said.splitlines() if len(line.split()) > 2)
    version = macros["__VERSION__"].strip('"')
    version = version if "__clang__" in macros else "GNU " + version.split()[0]
    sets = [name for name in ("AVX512F", "AVX2", "AVX", "SSE2") if f"__{name}__" in macros][:1]
    sets += ["FMA"] if "__FMA__" in macros else []
    tuned = [name[7:-2] for name in sorted(macros) if re.fullmatch(r"__tune_\w+__", name)]
    return ", ".join([version, " ".join(sets), *("for " + name for name in tuned)])


def recorded():
    if not RECORD.exists():
        return {}
    with open(RECORD) as file:
        return {(row["build"], row["command"]): int(row["instructions"]) for row in csv.DictReader(file)}


def write(record):
    with open(RECORD, "w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["build", "command", "instructions"])
        rows.writerows([build, command, n] for (build, command), n in sorted(record.items()))


def skipped(why):
    print("skipped:", why)
    sys.exit(77)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("hb")
    parser.add_argument("--record", action="store_true")
    parser.add_argument("compiler", nargs="+")
    asked = parser.parse_args()
    asked.build = build_of(asked.compiler)
    if shutil.which("valgrind") is None:
        skipped("valgrind is not installed (tools/setup.sh tests)")
    if "AVX512" in asked.build:
        skipped("valgrind does not know AVX-512; the preset avx2 can be counted")
    record, failed = recorded(), False
    if not asked.record and not all((asked.build, "hb " + line) in record for line in COMMANDS):
        skipped(f"no counts on record for {asked.build}; --record adds them")
    for line in COMMANDS:
        count = counted(asked.hb, line)
        if count is None:
            skipped(f"valgrind does not know all instructions of this build ({asked.build})")
        before = record.get((asked.build, "hb " + line))
        if asked.record:
            record[asked.build, "hb " + line] = count
        print(f"hb {line}: {count / 1e6:.1f} million instructions" + (f", on record {before / 1e6:.1f}" if before else ""))
        if not asked.record and count > (1 + MARGIN) * before:
            print(f"  {100 * (count / before - 1):.0f} % more, allowed: {100 * MARGIN:.0f} %. Meant? Then --record it.")
            failed = True
        if not asked.record and count < (1 - MARGIN) * before:
            print(f"  {100 * (1 - count / before):.0f} % fewer: --record it, so that this gain is kept")
    if asked.record:
        write(record)
    sys.exit(failed)


if __name__ == "__main__":
    main()
