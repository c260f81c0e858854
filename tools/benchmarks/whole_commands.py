"""Processor seconds and memory of whole commands, and what their JSON documents claim.

Programs that are compared run in turn, so that a busy machine slows both alike; seconds are the processor's, of the
program and of the kernel for it, never the clock's. The smallest of several runs stands for a command, and beside it the
spread (largest over smallest - 1)."""

import argparse
import json
import math
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

root = pathlib.Path(__file__).resolve().parent.parent.parent


class Run:
    """One run of a program: seconds of the processor and by the clock, peak megabytes, exit status, standard output."""

    def __init__(self, argv, keep=False):
        with tempfile.TemporaryFile() as out:
            start = time.monotonic()
            child = subprocess.Popen([str(a) for a in argv], cwd=root, stdin=subprocess.DEVNULL, stdout=out,
                                     stderr=subprocess.DEVNULL)
            _, status, usage = os.wait4(child.pid, 0)
            self.clock = time.monotonic() - start
            child.returncode = self.status = os.waitstatus_to_exitcode(status)
            self.seconds, self.megabytes = usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024
            out.seek(0)
            self.out = out.read().decode() if keep else ""

    def answered(self):
        """Exit status 3: an answer, parts of which miss the accuracy asked for or are unstable."""
        return self.status in (0, 3)


class Times:
    """Of the runs of one command."""

    def __init__(self):
        self.seconds, self.megabytes = [], 0.0

    def add(self, run):
        self.seconds.append(run.seconds)
        self.megabytes = max(self.megabytes, run.megabytes)

    def smallest(self):
        return min(self.seconds)

    def spread(self):
        return max(self.seconds) / min(self.seconds) - 1


def in_turn(commands, runs, budget=120.0, memory=True):
    """Times of commands that run one after the other, `runs` times, fewer past `budget` seconds of all together.
    The first document of each stands beside; None for a command that does not answer."""
    times, documents = [Times() for _ in commands], [None] * len(commands)
    for k in range(runs):
        for i, argv in enumerate(commands):
            if k and documents[i] is None:
                continue
            run = Run(argv, keep=k == 0)
            if k == 0 and run.answered():
                documents[i] = run.out
            times[i].add(run)
        if sum(sum(t.seconds) for t in times) > budget:
            break
    for argv, t in zip(commands, times):
        t.megabytes = memory_of(argv, t.megabytes) if memory else math.nan
    return [t if d is not None else None for t, d in zip(times, documents)], documents


def memory_of(argv, seen):
    """Peak megabytes. Of a small program the system tells the interpreter's that started it: that of GNU time is smaller."""
    if seen > 1.2 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:
        return seen
    gnu_time = shutil.which("time")
    if gnu_time is None:
        return math.nan
    with tempfile.NamedTemporaryFile() as out:
        Run([gnu_time, "-o", out.name, "-f", "%M", *argv])
        return int(out.read().split()[-1]) / 1024


def flat(value):
    if isinstance(value, list):
        return [x for y in value for x in flat(y)]
    return [value]


def document(text):
    try:
        return json.loads(text)
    except (TypeError, ValueError):
        return {}


def claims(text):
    """Largest claimed errors of a document: of q, relative; of growth rates, per unit time; of boundaries, of their place
    (a map's in units of its axis). None where it says nothing."""
    d = document(text)
    rods = [r for r in d.get("rods", {}).values() if isinstance(r, dict)] if isinstance(d.get("rods"), dict) else []

    def largest(values):
        values = [v for v in values if isinstance(v, (int, float))]
        return max(values) if values else None

    q = largest(x for r in rods for x in flat(r.get("error_bound", [])))
    growth = largest(x for r in rods for x in flat(r.get("exponent_error", r.get("growth_error", []))))
    curves = [c.get("error") for c in d["boundaries"]] if isinstance(d.get("boundaries"), list) else []
    ends = [e for bands in d.get("band_details", {}).values() for band in bands for e in (band.get("from_error"), band.get("to_error"))]
    return q, growth, largest(flat(curves) + ends)


def commit():
    """The last one that changed what the command is made of, for the first line of a table."""
    git = lambda *words: subprocess.run(["git", *words, "--", "lib", "hb", "tools/command", "tools/output", "tools/work"],
                                        cwd=root, capture_output=True, text=True).stdout.strip()
    return git("log", "-1", "--format=commit %h") + (" with changes" if git("status", "--porcelain") else "")


def number(value, digits=".1e"):
    return "" if value is None else format(value, digits)


def processor():
    with open("/proc/cpuinfo") as file:
        return next((line.split(":")[1].strip() for line in file if line.startswith("model name")), "unknown")


def flags_of(build):
    """Compiler flags of a build folder, by CMake's record of them."""
    cache = dict(line.strip().split("=", 1) for line in open(pathlib.Path(build) / "CMakeCache.txt") if "=" in line)
    value = lambda name: next((v for k, v in cache.items() if k.startswith(name + ":")), "")
    compiler = subprocess.run([value("CMAKE_CXX_COMPILER"), "-dumpfullversion"], capture_output=True, text=True).stdout.strip()
    return (f"{pathlib.Path(value('CMAKE_CXX_COMPILER')).name} {compiler} {value('CMAKE_CXX_FLAGS_RELEASE')}"
            f"{'' if value('HB_NATIVE') != 'ON' else ' -march=x86-64-v3' if value('HB_AVX512') == 'OFF' else ' -march=native'}")


def asked_of_a_table(runs):
    """What the writer of a table is called with: the command, how often, which rows."""
    parser = argparse.ArgumentParser()
    parser.add_argument("hb", nargs="?", default=root / "build" / "release" / "bin" / "hb", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=runs)
    parser.add_argument("--only", default="")
    asked = parser.parse_args()
    asked.hb = asked.hb.resolve()
    return asked


def write_table(name, asked, about, columns, rows):
    """Into results/benchmarks; a part of the rows to standard output."""
    lines = [f"# {processor()}; {commit()}; {flags_of(asked.hb.parent.parent)}; {about}", columns, *rows]
    if asked.only:
        print("\n".join(lines))
    else:
        (root / "results" / "benchmarks" / name).write_text("\n".join(lines) + "\n")


def say(text):
    print(text, file=sys.stderr, flush=True)
