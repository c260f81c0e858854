"""What cannot be read, and what cannot be asked."""

from __future__ import annotations

import importlib
import re
from typing import NamedTuple, Optional

_LINE = re.compile(r"^(?P<place>.*?): (?:(?P<key>[^\s:]+): )?found (?P<found>.*), allowed:? (?P<allowed>.*)$", re.DOTALL)
_PLACE = re.compile(r"^(?P<file>.*):(?P<line>\d+)(?:: column \d+)?$", re.DOTALL)


class Error(ValueError):
    """Of this package."""


class SceneProblem(NamedTuple):
    """One thing that is wrong with a scene; what the message does not say is "" or None."""

    file: str
    line: Optional[int]
    key: str
    found: str
    allowed: str


def _problem(text: str) -> SceneProblem:
    match = _LINE.match(text)
    if match is None:
        place, _, rest = text.partition(": ")
        file = _PLACE.match(place)
        if file is None:
            return SceneProblem(place if rest else "", None, "", rest or text, "")
        return SceneProblem(file["file"], int(file["line"]), "", rest, "")
    place, key = match["place"], match["key"] or ""
    file = _PLACE.match(place)
    if file is not None:
        return SceneProblem(file["file"], int(file["line"]), key, match["found"], match["allowed"])
    if not key and "." in place and "/" not in place and "=" not in place and not place.endswith(".toml"):
        return SceneProblem("", None, place, match["found"], match["allowed"])  # a path alone
    path, equals, _ = place.partition("=")
    if equals and not key:
        key = path
    return SceneProblem(place, None, key, match["found"], match["allowed"])


class SceneError(Error):
    """A scene that cannot be. `file`, `line`, `key`, `found` and `allowed` are those of the first problem; `problems`
    has all of them. Where a changed number is to blame, "PATH=VALUE" stands in the place of file and line."""

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.problems: list[SceneProblem] = [_problem(line) for line in message.split("\n")]

    @property
    def file(self) -> str:
        return self.problems[0].file

    @property
    def line(self) -> Optional[int]:
        return self.problems[0].line

    @property
    def key(self) -> str:
        return self.problems[0].key

    @property
    def found(self) -> str:
        return self.problems[0].found

    @property
    def allowed(self) -> str:
        return self.problems[0].allowed


class RequestError(Error):
    """A call that cannot be answered: the argument `field` was `found`, what is `allowed` instead."""

    def __init__(self, message: str, field: str = "", found: str = "", allowed: str = "") -> None:
        super().__init__(message, field, found, allowed)
        self.field = field
        self.found = found
        self.allowed = allowed

    def __str__(self) -> str:
        return str(self.args[0])


class MissingPackage(Error, ImportError):
    """A package that only this call needs is not there: `package`, and its name in Debian, `debian`."""

    def __init__(self, package: str, needed_by: str) -> None:
        self.package = package
        self.debian = f"python3-{package}"
        super().__init__(
            f"{needed_by} needs the package {package}, which this Python does not have: "
            f"apt install {self.debian} (or pip install {package})"
        )


def require(package: str, needed_by: str) -> None:
    """Imports what a call needs, or says what to install."""
    try:
        importlib.import_module(package)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise  # it is there, and something of its own is missing
        raise MissingPackage(package, needed_by) from None


def refused(field: str, found: object, allowed: str) -> RequestError:
    """The error of an argument, in the words of all others."""
    words = found if isinstance(found, str) else repr(found)
    words = " ".join(words.split())
    words = words if len(words) <= 80 else words[:80] + "..."
    return RequestError(f"{field}: found {words}, allowed: {allowed}", field, words, allowed)
