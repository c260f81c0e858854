#!/usr/bin/env python3
"""Pages for scdoc from what the program says of itself: pages.py HB TEMPLATE_FOLDER OUT_FOLDER."""
import pathlib
import re
import subprocess
import sys

program, templates, out = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])


def said(*arguments):
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=True).stdout


def escaped(text):
    return re.sub(r"([\\*_<>\[\]#`|])", r"\\\1", text)


def listed(text, heading):
    """[(name, description)] of a section of the help, continuation lines joined."""
    found, inside = [], False
    for line in text.splitlines():
        if not line.startswith(" "):
            inside = line == heading
        elif inside and re.match(r"  \S", line):
            name, _, description = line.strip().partition("  ")
            found.append([name, description.strip()])
        elif inside:
            found[-1][1] = (found[-1][1] + " " + line.strip()).strip()
    return found


def filled(template, values):
    text = (templates / template).read_text()
    for key, value in values.items():
        text = text.replace(f"@{key}@", value)
    return text


def definitions(entries):
    return "\n\n".join(f"*{escaped(name)}*\n\t{escaped(description)}" for name, description in entries)


out.mkdir(parents=True, exist_ok=True)
whole = said("--help")
subcommands = listed(whole, "Subcommands:")
head = whole.split("Usage:")[0].strip()
before, _, status = head.partition("Exit status:")
description = before.partition("To begin:")[0]
statuses = [part.strip() for part in status.replace("\n", " ").strip().rstrip(".").split(", ") if part.strip()]
(out / "hb.1.scd").write_text(filled("hb.1.scd", {
    "DESCRIPTION": description.strip().rstrip(".").lower(),
    "SUBCOMMANDS": definitions(subcommands),
    "EXIT_STATUS": "\n\n".join("*{}*\n\t{}".format(*map(escaped, part.split(" ", 1))) for part in statuses),
    "SEE_ALSO": ", ".join(f"*hb-{name}*(1)" for name, _ in subcommands)}))
for name, description in subcommands:
    text = said(name, "--help")
    usage = re.search(r"Usage: (.*)", text)[1]
    (out / f"hb-{name}.1.scd").write_text(filled("subcommand.1.scd", {
        "NAME": name.upper(), "name": name, "DESCRIPTION": escaped(description), "SYNOPSIS": escaped(usage),
        "OPTIONS": definitions(listed(text, "Positionals:") + listed(text, "Options:"))}))
