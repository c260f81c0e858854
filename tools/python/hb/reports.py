"""HTML pages of results, and results in notebooks."""

from __future__ import annotations

import html
import io
import os
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _core
from .errors import refused

if TYPE_CHECKING:
    from .bench import Bench
    from .check import Check
    from .map import Map
    from .scene import Scene
    from .steady import Steady
    from .sweep import Sweep
    from .tune import Tune


def preformatted(text: str) -> str:
    return f'<pre style="white-space: pre">{html.escape(text)}</pre>'


def _path(file: Any) -> str:
    try:
        path = os.fspath(file)
    except TypeError:
        raise refused("file", file, "the page's file, as in \"report.html\"") from None
    if not isinstance(path, str) or not path:
        raise refused("file", path, "the page's file, as in \"report.html\"")
    return path


def _call(method: str, arguments: dict[str, Any]) -> str:
    """The call as it stands in the page."""
    silent = {"threads", "progress"}
    given = [f"{k}={v!r}" for k, v in arguments.items() if v is not None and k not in silent and (k, v) != ("theory", "linear")]
    return f"hb.Scene.{method}({', '.join(given)})"


def _threads(threads: Any) -> int:
    if threads == "all":
        return os.cpu_count() or 1
    if isinstance(threads, bool) or not isinstance(threads, int) or not 1 <= threads <= 1024:
        raise refused("threads", threads, 'an integer 1 to 1024, or "all"')
    return threads


def in_words(result: Union["Bench", "Check"], kind: str, file: Any) -> None:
    """A page of the result's table and, with matplotlib, its picture; the file is whole or not there."""
    path = _path(file)
    title = html.escape(f"hb {kind}: {result.title or result.scene.name}")
    page = (
        f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{title}</title></head>'
        f"<body><h1>{title}</h1>{preformatted(str(result))}{_picture(result)}</body></html>\n"
    )
    unfinished = path + ".part"
    try:
        with open(unfinished, "w", encoding="utf-8") as out:
            out.write(page)
        os.replace(unfinished, path)
    finally:
        if os.path.exists(unfinished):
            os.remove(unfinished)


def _picture(result: Union["Bench", "Check"]) -> str:
    """What plot() draws, as SVG; nothing without matplotlib."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return ""
    figure = Figure(figsize=(8, 4.6), layout="constrained")
    result.plot(ax=figure.add_subplot())
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


def steady(result: "Steady", file: Any) -> None:
    _core.steady_report(result.scene._core, result._answer, _path(file), _call("steady", result._arguments))


def sweep(result: "Sweep", file: Any, *, pictures: bool, threads: Any) -> None:
    scene(result.scene, result, None, file, pictures=pictures, threads=threads)


def scene(scene: "Scene", sweep: "Sweep", map: Optional["Map"], file: Any, *, pictures: bool, threads: Any) -> None:
    core = None if map is None else map._core
    call = _call("sweep", sweep._arguments)
    _core.sweep_report(scene._core, sweep._core, core, _path(file), call, bool(pictures), _threads(threads))


def map(result: "Map", file: Any) -> None:
    _core.map_report(result.scene._core, result._core, _path(file), _call("map", result._arguments))


def tune(result: "Tune", file: Any) -> None:
    _core.tune_report(result.before._core, result._core, _path(file), _call("tune", result._arguments))
