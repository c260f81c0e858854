"""Run times of two commits of this project: python3 before_and_after.py OLD_COMMIT [--new COMMIT]
[--runs N] [--only WORD].

Builds the command of both (default: of what is checked out; --new may also be a folder where the command is built) under
build/before_and_after, runs both on the same scenes in
turn, and writes results/benchmarks/before_and_after.csv. Where answers differ by more than the errors that both claim, the
row says so. Between the rows a yardstick that neither commit changes (Eigen's product of matrices) shows how even the
machine was."""

import argparse
import math
import pathlib
import subprocess

from whole_commands import (claims, commit, document, flags_of, flat, in_turn, number, processor, root, say)

SIX, MATHIEU = "results/six_link/scene.toml", "results/mathieu/scene.toml"
COEFFICIENT = "hill.stiffness.1.cos.0.0"

# What both are asked, what only the new one is asked beside it (it may be told to leave out what the old one does not know),
# and how comparable the work is.
ROWS = (
    (f"steady {SIX} --rpm 1000 --json", "", "more"),
    (f"steady {SIX} --rpm 1000 --json --only steady,stability", "", "more"),
    (f"steady {SIX} --rpm 1000 --json --only stability", "", "equal"),
    (f"steady {MATHIEU} --omega 1 --json", "", "equal"),
    (f"sweep {SIX} --rpm 200:1500:10 --json", "", "more"),
    (f"sweep {SIX} --rpm 200:1500:10 --json --only steady,stability", "--no-search", "no search"),
    (f"sweep {SIX} --rpm 200:1500:10 --json --only stability", "", "equal"),
    (f"sweep {SIX} --rpm 200:1500:10 --json --only stability", "--no-search", "no search"),
    (f"sweep {SIX} --rpm 200:3000:20 --json", "", "more"),
    (f"sweep {SIX} --rpm 200:3000:20 --json --only stability", "", "equal"),
    (f"sweep {MATHIEU} --omega 0.32:4:0.01 --json", "", "equal"),
    (f"map {MATHIEU} --x omega=0.5:3:400 --y {COEFFICIENT}=0.05:1:400 --json", "", "equal"),
    (f"map {SIX} --x rpm=300:3000:100 --y *.J=30:100:100 --modes 1 --json", "", "equal"),
    (f"map {SIX} --x rpm=200:3000:8 --y AB.J=20:90:6 --json", "", "equal"),
    ("tune results/tune_six_link/scene.toml --minimise mass --vary AB.section.height=5:30 --vary CD.section.height=5:30"
     " --keep stable>=5 --keep deflection<=2 --over rpm=300:3000 --json", "", "more"),
)


def built(commit):
    """The command of a commit, built as its preset for this machine says; one compiler at a time, behind all others."""
    name = subprocess.run(["git", "rev-parse", commit + "^{commit}"], cwd=root, capture_output=True, text=True, check=True).stdout.strip()
    folder = root / "build" / "before_and_after" / name[:12]
    if not (folder / "CMakeLists.txt").exists():
        folder.mkdir(parents=True)
        archive = subprocess.Popen(["git", "archive", name], cwd=root, stdout=subprocess.PIPE)
        subprocess.run(["tar", "-x", "-C", folder], stdin=archive.stdout, check=True)
        if archive.wait():
            raise SystemExit(f"git archive {name} failed")
    say(f"building {name[:12]}")
    headers = root / "build" / "sundials" / "usr" / "include"
    known = [f"-DHB_SUNDIALS_HEADERS={headers}"] if headers.exists() else []
    for step in (["cmake", "--preset", "release", "-DHB_BENCHMARKS=OFF", "-DBUILD_TESTING=OFF", *known],
                 ["nice", "cmake", "--build", "--preset", "release", "--parallel", "1", "--target", "hb_command"]):
        subprocess.run(step, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, check=True)
    return name[:12], folder / "build" / "release"


class Differences:
    """How far two answers are apart, in units of the errors that both claim."""

    def __init__(self):
        self.worst, self.what, self.words = 0.0, "", []

    def number(self, what, a, b, error):
        if None in (a, b, error) or not all(map(math.isfinite, (a, b, error))):
            return
        error += 4e-15 * max(abs(a), abs(b))  # the last digits of both documents
        share = abs(a - b) / error if error else (0.0 if a == b else math.inf)
        if share > self.worst:
            self.worst, self.what = share, f"{what} {a:.10g} / {b:.10g}"

    def numbers(self, what, a, b, ea, eb):
        a, b, ea, eb = (flat(v) for v in (a, b, ea, eb))
        if len(a) == len(b) == len(ea) == len(eb):
            for x, y, ex, ey in zip(a, b, ea, eb):
                self.number(what, x, y, None if None in (ex, ey) else ex + ey)

    def verdicts(self, a, b):
        """Where both decide, they must decide alike."""
        a, b = flat(a), flat(b)
        if len(a) != len(b):
            return
        other = sum(1 for x, y in zip(a, b) if x != y and None not in (x, y) and "undecided" not in (x, y))
        if other:
            self.words.append(f"{other} of {len(a)} verdicts differ")

    def bands(self, rod, a, b):
        if len(a) != len(b):
            self.words.append(f"{rod}: {len(a)} unstable bands before and {len(b)} now")
            return
        for x, y in zip(a, b):
            for end in ("from", "to"):
                errors = x.get(end + "_error"), y.get(end + "_error")
                self.number(f"{rod} band {end}", x[end], y[end], None if None in errors else sum(errors))

    def said(self):
        worst = f"apart by {self.worst:.2g} of their errors" if self.what else "equal"
        if self.worst > 1:
            worst = f"DIFFER by {self.worst:.2g} times their errors: {self.what}"
        return "; ".join([worst, *self.words])


def apart(old, new):
    """Of q's amplitudes, growth rates, ends of bands, verdicts and the goal of tune."""
    a, b, result = document(old), document(new), Differences()
    if not a or not b:
        return "not compared"
    if "goal" in a:
        errors = [d["goal"].get("error") for d in (a, b)]
        result.number("goal", a["goal"]["after"], b["goal"]["after"], None if None in errors else sum(errors))
        return f"goal {a['goal']['after']:.6g} before, {b['goal']['after']:.6g} now; designs {a.get('analyses')}, {b.get('analyses')}"
    for rod in a.get("rods", {}):
        x, y = a["rods"][rod], b["rods"].get(rod)
        if y is None:
            continue
        if "q" in x and "q" in y:  # one speed: an amplitude relative to the largest
            for p, r in zip(flat(x["q"]["max_abs"]), flat(y["q"]["max_abs"])):
                size = max(flat(x["q"]["max_abs"]))
                result.number(f"{rod} max |q|", p, r, size * (x["error_bound"] + y["error_bound"]))
            result.number(f"{rod} growth", x.get("growth_rate"), y.get("growth_rate"),
                          sum(v.get("exponent_error") or 0 for v in (x, y)))
        else:
            result.numbers(f"{rod} growth", x.get("growth_rate", []), y.get("growth_rate", []), x.get("growth_error", []), y.get("growth_error", []))
            for p, r, ep, er in zip(x.get("max_abs", []), y.get("max_abs", []), x.get("error_bound", []), y.get("error_bound", [])):
                size = max(flat(p), default=None)
                if size is not None and None not in (ep, er):
                    for v, w in zip(flat(p), flat(r)):
                        result.number(f"{rod} max |q|", v, w, size * (ep + er))
        result.verdicts(x.get("verdict", []), y.get("verdict", []))
        if "band_details" in a and "band_details" in b:
            result.bands(rod, a["band_details"].get(rod, []), b["band_details"].get(rod, []))
    if isinstance(a.get("boundaries"), list) and isinstance(b.get("boundaries"), list):
        result.words.append(f"{len(a['boundaries'])} boundary curves before, {len(b['boundaries'])} now")
    return result.said()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("old")
    parser.add_argument("--new", default="HEAD")
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--only", default="")
    asked = parser.parse_args()
    old, old_build = built(asked.old)
    new, new_build = (commit(), pathlib.Path(asked.new).resolve()) if (pathlib.Path(asked.new) / "bin" / "hb").exists() else built(asked.new)
    subprocess.run([root / "tools" / "build.sh", "release", "hb_yardsticks"], stdout=subprocess.DEVNULL, check=True)
    yardstick = [root / "build" / "release" / "bin" / "hb_yardsticks", "dgemm"]
    lines = [f"# {processor()}; before {old}: {flags_of(old_build)}; now {new}: {flags_of(new_build)}",
             "# processor seconds of one thread: smallest of the runs, in turn; spread: largest over smallest - 1",
             "command,flags of the new one only,work of the new one,seconds before,seconds now,ratio,spread before,spread now,"
             "runs,yardstick seconds,yardstick spread,claimed error of q before,now,of growth rates before [1/time],now,answers"]
    for command, flags, work in ROWS:
        if asked.only not in command:
            continue
        say(f"{command} {flags}")
        pair = [[build / "bin" / "hb", *command.split(), *more] for build, more in
                ((old_build, []), (new_build, flags.split()))]
        (before, now, measure), documents = in_turn([*pair, yardstick], asked.runs, budget=60, memory=False)
        if before is None or now is None:
            lines.append(f'"hb {command}",{flags},not comparable: {"the old" if before is None else "the new"} one refuses' + "," * 13)
            continue
        if "--json" not in command:
            documents = ["", "", ""]
        q, growth, _ = zip(claims(documents[0]), claims(documents[1]))
        lines.append(",".join([
            f'"hb {command}"', flags, work, f"{before.smallest():.4f}", f"{now.smallest():.4f}",
            f"{now.smallest() / before.smallest():.2f}", f"{before.spread():.2f}", f"{now.spread():.2f}", str(len(now.seconds)),
            f"{measure.smallest():.3f}", f"{measure.spread():.2f}", *map(number, q), *map(number, growth),
            f'"{apart(documents[0], documents[1])}"']))
        say(lines[-1])
    target = root / "results" / "benchmarks" / "before_and_after.csv"
    if not asked.only:
        target.write_text("\n".join(lines) + "\n")
    else:
        print("\n".join(lines))


if __name__ == "__main__":
    main()
