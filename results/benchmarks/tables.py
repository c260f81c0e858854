#!/usr/bin/env python3
"""Writes commands.csv and before_and_after.csv as tables into README.md, between <!-- NAME --> and <!-- end -->."""
import csv
import pathlib
import re

here = pathlib.Path(__file__).parent
SHORT = ((r"results/(\w+)/scene\.toml", r"\1"), (r"hill\.stiffness\.1\.cos\.0\.0", "modulation"), (r" --minimise.*", ""))


def read(name):
    """The remarks at the head of a file, and its rows."""
    lines = (here / name).read_text().splitlines()
    remarks = [line[2:] for line in lines if line.startswith("# ")]
    return remarks, list(csv.reader(line for line in lines if not line.startswith("# ")))[1:]


def named(command, flags=""):
    if not command.startswith("hb ") and not flags and not command.startswith(("steady", "sweep", "map", "tune")):
        return command  # a yardstick
    for long, short in SHORT:
        command = re.sub(long, short, command)
    if not re.search(r"\bmap\b", command):
        command = command.replace(" --json", "")
    return f"`{command}{f' (now: {flags})' if flags else ''}`"


def seconds(text):
    s = float(text)
    for unit, size in (("s", 1), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if s >= size:
            return f"{s / size:.3g} {unit}"
    return f"{s:.3g} s"


def commands():
    remarks, rows = read("commands.csv")
    table = ["command | processor time | an answer | memory | claimed errors: q, growth rate [1/time], ends and boundaries"]
    for command, answers, time, _, _, each, memory, q, growth, ends, remark in rows:
        errors = ", ".join(error or "-" for error in (q, growth, ends)) if q or growth or ends else remark
        table.append(" | ".join((named(command), seconds(time), seconds(float(each) / 1e3) if int(answers) > 1 else "",
                                 f"{memory} MB" if memory else "", errors)))
    return remarks, table


def before_and_after():
    remarks, rows = read("before_and_after.csv")
    table = ["command | work of the new one | before | now | ratio | answers"]
    for row in rows:
        command, flags, work, old, new, ratio = row[:6]
        table.append(" | ".join((named(command, flags), work, seconds(old), seconds(new), ratio, row[-1])))
    return remarks, table


def main():
    page = (here / "README.md").read_text()
    for name, made in (("commands.csv", commands()), ("before_and_after.csv", before_and_after())):
        remarks, (head, *rows) = made
        lines = [f"{'; '.join(remarks)}:", "", f"| {head} |", f"|{' --- |' * (head.count('|') + 1)}",
                 *(f"| {row} |" for row in rows)]
        text = "\n".join(line.rstrip() for line in lines)
        page, count = re.subn(rf"(<!-- {re.escape(name)} -->\n).*?(\n<!-- end -->)",
                              lambda place: place[1] + text + place[2], page, flags=re.S)
        if count != 1:
            raise SystemExit(f"README.md: found {count} places for {name}, allowed: one")
    (here / "README.md").write_text(page)


if __name__ == "__main__":
    main()
