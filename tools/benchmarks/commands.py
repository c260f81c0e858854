"""Processor seconds, memory and claimed errors of whole commands: python3 commands.py [HB] [--runs N] [--only WORD] writes
results/benchmarks/commands.csv (with --only: prints those that contain WORD). HB: the command, default that of the build
`release`. In the same run: a dense Hill solution, shooting with SUNDIALS CVODE, Eigen's product of matrices, and AUTO-07p
where it is installed."""

import subprocess

from auto_07p import MESHES, Mathieu, installed
from whole_commands import asked_of_a_table, claims, in_turn, number, root, say, write_table

SIX, MATHIEU = "results/six_link/scene.toml", "results/mathieu/scene.toml"
PLANE = f"{MATHIEU} --x omega=0.5:3:1000 --y hill.stiffness.1.cos.0.0=0.05:1:1000"
ONE_MODE = f"{SIX} --x rpm=300:3000:1000 --y *.J=30:100:1000 --modes 1"
FIVE_MODES = f"{SIX} --x rpm=200:3000:{{0}} --y AB.J=20:90:{{0}}"

# Command, and how many answers it gives.
ROWS = (
    (f"steady {SIX} --rpm 1000 --json", 1),
    (f"steady {SIX} --rpm 1000 --json --only growth", 1),
    (f"sweep {SIX} --rpm 200:1500:10 --json --only steady,stability --no-search", 131),
    (f"sweep {SIX} --rpm 200:1500:10 --json --no-search", 131),
    (f"sweep {SIX} --rpm 200:1500:10 --json", 131),
    (f"sweep {SIX} --rpm 200:1500:10 --json --only growth", 131),
    (f"sweep {SIX} --rpm 200:3000:20 --json --only steady,stability --no-search", 141),
    (f"sweep {SIX} --rpm 200:3000:20 --json", 141),
    (f"sweep {MATHIEU} --omega 0.32:4:0.01 --json", 369),
    (f"sweep {MATHIEU} --omega 0.32:4:0.01 --json --only steady,stability --no-search", 369),
    (f"map {PLANE}", 10**6),
    (f"map {PLANE} --json", 10**6),
    (f"map {ONE_MODE}", 10**6),
    (f"map {ONE_MODE} --json", 10**6),
    (f"map {FIVE_MODES.format(20)} --json", 400),
    (f"map {FIVE_MODES.format(20)} --json --no-boundaries", 400),
    (f"map {FIVE_MODES.format(200)} --json --no-boundaries", 40000),
    ("tune results/tune_six_link/scene.toml --minimise mass --vary AB.section.height=5:30 --vary CD.section.height=5:30"
     " --keep stable>=5 --keep deflection<=2 --over rpm=300:3000 --json", 1),
)


def command_rows(hb, asked):
    for line, answers in ROWS:
        if asked.only not in line:
            continue
        say("hb " + line)
        (times,), (text,) = in_turn([[hb, *line.split()]], asked.runs, budget=20)
        if times is None:
            yield f'"hb {line}",{answers},,,,,,,,refused'
            continue
        q, growth, place = claims(text)
        yield (f'"hb {line}",{answers},{times.smallest():.4f},{times.spread():.2f},{len(times.seconds)},'
               f"{1000 * times.smallest() / answers:.4g},{times.megabytes:.0f},{number(q)},{number(growth)},{number(place)},")


def auto_rows(hb, asked):
    if asked.only not in "AUTO-07p":
        return
    if not installed():
        yield '"AUTO-07p: forced Mathieu equation, 0.32 to 4",,,,,,,,,,not installed'
        return
    for mesh in MESHES:
        system = Mathieu(*mesh)
        (times,), _ = in_turn([system.argv], asked.runs)
        answers = len(system.answers())
        yield (f'"{system.name}, forced Mathieu equation, 0.32 to 4",{answers},{times.smallest():.4f},{times.spread():.2f},'
               f"{len(times.seconds)},{1000 * times.smallest() / answers:.4g},{times.megabytes:.0f},,,,error of the norm of q {system.error(hb):.1e}")


def yardstick_rows(asked):
    if asked.only not in "yardsticks":
        return
    run = subprocess.run([root / "build" / "release" / "bin" / "hb_yardsticks"], capture_output=True, text=True, check=True)
    for line in run.stdout.splitlines()[2:]:
        name, what, seconds, error = line.split(",")
        yield f'"{name}: {what}",1,{seconds},,,{1000 * float(seconds):.4g},,,,,{"error of q " + error if error else ""}'


def main():
    asked = asked_of_a_table(runs=7)
    write_table("commands.csv", asked,
                "processor seconds of one thread, smallest of the runs; spread: largest over smallest - 1",
                "command,answers,seconds,spread,runs,milliseconds an answer,peak MB,claimed error of q,of growth rates [1/time],"
                "of ends and boundaries,remark",
                [*yardstick_rows(asked), *command_rows(asked.hb, asked), *auto_rows(asked.hb, asked)])


if __name__ == "__main__":
    main()
