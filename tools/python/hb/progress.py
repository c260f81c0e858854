"""How far long work is."""

from __future__ import annotations

import sys
from typing import Callable, Optional, Union

from .errors import refused

Progress = Union[bool, Callable[[str, int, int], object], None]
"""False or None: silent; True: a line on standard error; else called with (what, done, total), some times a second."""


def teller(progress: Progress) -> Optional[Callable[[str, int, int], object]]:
    if progress is None or progress is False:
        return None
    if progress is True:
        return _line
    if not callable(progress):
        raise refused("progress", progress, "True, False, or a function of (what, done, total)")
    return progress


def _line(what: str, done: int, total: int) -> None:
    sys.stderr.write(f"\r\033[K{what}: {done} of {total}")
    sys.stderr.flush()


def finish(progress: Progress) -> None:
    if progress is True:
        sys.stderr.write("\r\033[K")
        sys.stderr.flush()
