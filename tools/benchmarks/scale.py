"""How the cost of whole commands grows with modes, speeds, points, threads and ranks: python3 scale.py [HB]
[--runs N] [--only WORD] writes results/benchmarks/scale.csv (with --only: prints the rows whose `along` contains WORD).

Processor seconds are the smallest of the runs. Threads and ranks are a matter of the clock: those rows ask the system for
the cores before all other programs (`chrt --rr 1`, allowed to root), and are left out where it refuses."""

import os
import pathlib
import shutil
import subprocess

from whole_commands import Run, asked_of_a_table, claims, in_turn, number, root, say, write_table

SIX, MATHIEU = "results/six_link/scene.toml", "results/mathieu/scene.toml"
SWEEP = f"sweep {SIX} --json --no-plots"
PLANE = f"map {MATHIEU} --x omega=0.5:3:{{0}} --y hill.stiffness.1.cos.0.0=0.05:1:{{0}} --json"
ONE_MODE = f"map {SIX} --x rpm=300:3000:{{0}} --y *.J=30:100:{{0}} --modes 1 --json"
PLANE_OF_RODS = f"map {SIX} --x rpm=200:3000:{{0}} --y AB.J=20:90:{{0}} --json"

POINTS_ALONE = "--only steady,stability --no-search"

# Along what, how much of it, answers, command.
ONE_THREAD = (
    *(("modes", n, 27, f"{SWEEP} --rpm 200:1500:50 {POINTS_ALONE} --modes {n}") for n in (1, 2, 5, 10, 20)),
    *(("modes, growth rate alone", n, 27, f"{SWEEP} --rpm 200:1500:50 --only growth --modes {n}") for n in (1, 2, 5, 10, 20)),
    *(("speeds", n, n, f"{SWEEP} --rpm 200:1500:x{n} {POINTS_ALONE}") for n in (10, 100, 1000)),
    *(("speeds, growth rate alone", n, n, f"{SWEEP} --rpm 200:1500:x{n} --only growth") for n in (10, 100, 1000, 10000)),
    *(("speeds, Mathieu", n, n, f"sweep {MATHIEU} --omega 0.5:3:x{n} --json {POINTS_ALONE}") for n in (100, 1000, 10000, 100000)),
    *(("points, Mathieu", n * n, n * n, PLANE.format(n)) for n in (32, 100, 316, 1000, 2000)),
    *(("points, one mode", n * n, n * n, ONE_MODE.format(n)) for n in (32, 100, 316, 1000)),
    *(("points, five modes, without boundaries", n * n, n * n, PLANE_OF_RODS.format(n) + " --no-boundaries") for n in (10, 20, 40, 80)),
    *(("points, ten modes, without boundaries", n * n, n * n, PLANE_OF_RODS.format(n) + " --modes 10 --no-boundaries") for n in (10, 20, 40)),
)
# By the clock.
TOGETHER = (
    ("sweep", 131, f"{SWEEP} --rpm 200:1500:10"),
    ("sweep, growth rate alone", 2000, f"{SWEEP} --rpm 200:1500:x2000 --only growth"),
    ("map, Mathieu", 160000, PLANE.format(400)),
    ("map, Mathieu, large", 1000000, PLANE.format(1000)),
    ("map, one mode", 10000, ONE_MODE.format(100)),
    ("map, one mode, large", 1000000, ONE_MODE.format(1000)),
    ("map, five modes, without boundaries", 1600, PLANE_OF_RODS.format(40) + " --no-boundaries"),
    ("map, five modes", 400, PLANE_OF_RODS.format(20)),
)
FIRST = ["chrt", "--rr", "1"]


def errors(text):
    return ",".join(number(c) for c in claims(text))


def one_thread_rows(hb, asked):
    for along, size, answers, line in ONE_THREAD:
        if asked.only not in along:
            continue
        say(f"{along} {size}")
        (times,), (text,) = in_turn([[hb, *line.split(), "--threads", "1"]], asked.runs, budget=15)
        if times is None:
            yield f'"{along}",{size},{answers},1,,,,,,,,,"hb {line}"'
            continue
        yield (f'"{along}",{size},{answers},1,{times.smallest():.4f},{times.spread():.2f},,{1000 * times.smallest() / answers:.4g},'
               f'{times.megabytes:.0f},{errors(text)},"hb {line}"')


def ranks_of(hb, n):
    mpirun = shutil.which("mpirun")
    if mpirun is None or not (pathlib.Path(hb).parent / "hb_mpi").exists():
        return None
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return [mpirun, "--oversubscribe", "--bind-to", "none", "-n", str(n), hb]


def together_rows(hb, asked):
    if subprocess.run([*FIRST, "true"], stderr=subprocess.DEVNULL).returncode:
        say("threads and ranks: left out, other programs cannot be kept away")
        return
    for what, answers, line in TOGETHER:
        if asked.only not in "threads and ranks, " + what:
            continue
        say(what)
        ways = {"1 thread": [hb, "--threads 1"], "2 threads": [hb, "--threads 2"]}
        for n in (1, 2):
            start = ranks_of(hb, n)
            if start:
                ways[f"{n} rank{'s' * (n > 1)}"] = [*start, "--threads 1"]
        best = {}
        for _ in range(min(asked.runs, 3)):
            for name, (*program, threads) in ways.items():
                run = Run([*FIRST, *program, *line.split(), *threads.split()], keep=True)
                if run.answered() and (name not in best or run.clock < best[name].clock):
                    best[name] = run
        for name, run in best.items():
            faster = best["1 thread"].clock / run.clock
            same = "same document" if run.out == best["1 thread"].out else "ANOTHER DOCUMENT"
            yield (f'"{name}, {what}",{name.split()[0]},{answers},{faster:.2f},{run.seconds:.4f},,{run.clock:.4f},'
                   f'{1000 * run.clock / answers:.4g},,{errors(run.out)},"hb {line}; {same}"')


def main():
    asked = asked_of_a_table(runs=5)
    write_table("scale.csv", asked,
                "processor seconds, smallest of the runs; of threads and ranks the clock's, before all other programs; "
                "milliseconds: of what counts in that row",
                "along,how many,answers,times as fast as one thread,processor seconds,spread,seconds by the clock,"
                "milliseconds an answer,peak MB,claimed error of q,of growth rates [1/time],of ends and boundaries,command",
                [*one_thread_rows(asked.hb, asked), *together_rows(asked.hb, asked)])


if __name__ == "__main__":
    main()
