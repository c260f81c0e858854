#!/usr/bin/env python3
"""Rules of the house that no compiler checks: rules.py RULE ROOT; prints each breach, exit 1 where there is one."""
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[2]).resolve()


def sources(*rooms):
    for room in rooms:
        yield from (p for p in sorted((root / room).rglob("*")) if p.suffix in (".cpp", ".hpp"))


def lines(path):
    return enumerate(path.read_text().splitlines(), 1)


def room(path):
    """Rooms in the direction that data flow; a file may include those before its own, and its own."""
    if path.startswith(("tests/", "tools/attack/")):  # attacks are tests that take their time
        return 5
    for depth, name in enumerate(("lib", "hb/engine", "hb/analysis", "hb", "tools")):
        if path.startswith(name + "/"):
            return depth
    return None


def direction():
    """Includes go up the stream: tools -> hb -> hb/analysis -> hb/engine -> lib; no circle."""
    includes = {}
    for path in sources("lib", "hb", "tools"):
        here = path.relative_to(root).as_posix()
        includes[here] = []
        for number, line in lines(path):
            found = re.match(r'\s*#include "([^"]+)"', line)
            if not found:
                continue
            target = found[1]
            if not (root / target).exists():
                if room(target) is not None:
                    yield f"{here}:{number}: includes {target}, which does not exist"
                continue  # written at build time
            includes[here].append(target)
            if room(target) is None or room(target) > room(here):
                yield f"{here}:{number}: includes {target}, which lies below it"
    state = {}

    def visit(file, trail):
        state[file] = "open"
        for target in includes.get(file, ()):
            if state.get(target) == "open":
                yield "circle: " + " -> ".join(trail + [file, target])
            elif target not in state:
                yield from visit(target, trail + [file])
        state[file] = "done"

    for file in includes:
        if file not in state:
            yield from visit(file, [])


def silence():
    """Nothing below tools prints, reads flags, the environment or signals, or knows JSON or a network of processes."""
    forbidden = re.compile(
        r"\bprintf\(|std::cout|std::cerr|std::clog|getenv|<csignal>|\bsigaction\b|\bisatty\b|nlohmann|CLI11|\bMPI_|"
        r'"[^"]*\B--[a-z]')
    for path in sources("lib", "hb"):
        for number, line in lines(path):
            if forbidden.search(line):
                yield f"{path.relative_to(root)}:{number}: {line.strip()}"


def formulas():
    """Every formula that code or a page cites by file and number exists there, once."""
    numbered = {}
    for page in sorted(root.glob("lib/**/README.md")) + sorted(root.glob("hb/**/README.md")):
        name = page.relative_to(root).as_posix()
        numbered[name] = {}
        for number, line in lines(page):
            found = re.search(r"\s{2,}\(([A-Z]\d+[a-z]?)\)\s*$", line)
            if found and found[1] in numbered[name]:
                yield f"{name}:{number}: ({found[1]}) stands at line {numbered[name][found[1]]} too"
            if found:
                numbered[name].setdefault(found[1], number)
        for number, line in lines(page):
            own = re.sub(r"(lib|hb)/(\w+/)*README\.md,? \([A-Z]\d+[a-z]?\)", "", line)
            for cited in re.findall(r"\(([A-Z]\d+[a-z]?)\)", own):
                if cited not in numbered[name]:
                    yield f"{name}:{number}: cites ({cited}), which is not on the page"
    if not sum(map(len, numbered.values())):
        yield "no numbered formula found on any page"
    citation = re.compile(r"((?:lib|hb)/(?:\w+/)*README\.md),? ((?:\([A-Z]\d+[a-z]?\)(?:, | and | to )?)+)")
    count = 0
    for path in sources("lib", "hb", "tools", "tests"):
        text = re.sub(r"\n\s*// ?", " ", path.read_text())
        for page, cited in citation.findall(text):
            for formula in re.findall(r"\(([A-Z]\d+[a-z]?)\)", cited):
                count += 1
                if formula not in numbered.get(page, {}):
                    yield f"{path.relative_to(root)}: cites {page} ({formula}), which does not exist"
    if not count:
        yield "no citation found in any source"


def function_lengths(path, indent):
    """Name and lines of the functions that begin at this indentation, as clang-format lays them out."""
    text = path.read_text().splitlines()
    begin = None
    for number, line in enumerate(text):
        if begin is None:
            own = line.startswith(indent) and line[len(indent):len(indent) + 1].strip()
            if own and line.endswith("{") and "(" in line + "".join(text[max(0, number - 6):number]) and not re.match(
                    r"\s*(namespace|struct|class|enum|union|extern|if|for|while|switch|else|do)\b", line):
                begin = number
                while begin and text[begin - 1].startswith(indent) and not re.search(r"([;{}:]|^\s*|//.*|#.*)$", text[begin - 1]):
                    begin -= 1
        elif re.fullmatch(indent + r"\}(\)?;)?", line):
            yield begin + 1, number - begin + 1
            begin = None


def lengths():
    """No function has more than 80 lines; the file of a subcommand at most 150."""
    for path in sources("lib", "hb", "tools"):
        here = path.relative_to(root).as_posix()
        for indent in ("", "  "):
            for number, length in function_lengths(path, indent):
                if length > 80:
                    yield f"{here}:{number}: a function of {length} lines"
        text = path.read_text()
        if here.startswith("tools/command/") and re.search(r"^void add_\w+_command\(", text, re.M) and text.count("\n") > 150:
            yield f"{here}: {text.count(chr(10))} lines"


def installed():
    """An installed header includes the standard library, Eigen and other installed headers alone."""
    listed = re.search(r"set\(HB_PRIVATE_HEADERS([^)]*)\)", (root / "cmake/install.cmake").read_text())
    private = set(listed[1].split())
    for header in private:
        if not (root / header).exists():
            yield f"cmake/install.cmake: {header} does not exist"
    for path in sources("lib", "hb"):
        here = path.relative_to(root).as_posix()
        if path.suffix != ".hpp" or here in private:
            continue
        for number, line in lines(path):
            if found := re.match(r'\s*#include "([^"]+)"', line):
                if found[1] in private:
                    yield f"{here}:{number}: includes {found[1]}, which is not installed"
            elif (found := re.match(r"\s*#include <([^>]+)>", line)) and not re.fullmatch(r"Eigen/\w+|[a-z_]+", found[1]):
                yield f"{here}:{number}: includes {found[1]}, which its users may not have"


def format():
    """Sources are as clang-format writes them (.clang-format)."""
    files = list(sources("lib", "hb", "tools", "tests"))
    for start in range(0, len(files), 50):
        run = subprocess.run(["clang-format", "--dry-run", "--Werror", *map(str, files[start:start + 50])],
                             capture_output=True, text=True)
        yield from sorted({line.split(": error")[0] for line in run.stderr.splitlines() if ": error" in line})


breaches = list({"direction": direction, "silence": silence, "formulas": formulas, "lengths": lengths,
                 "installed": installed, "format": format}[sys.argv[1]]())
print("\n".join(breaches))
sys.exit(bool(breaches))
