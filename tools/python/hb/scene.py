"""Scenes: mechanisms with elastic links, or linear periodic systems."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _core, toml_text
from .errors import refused
from .progress import Progress, finish, teller

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .bench import Bench
    from .check import Check
    from .map import Map
    from .steady import Steady
    from .sweep import Sweep
    from .tune import Tune

Speed = Optional[Union[float, str]]
Names = Union[str, Sequence[str], None]
Modes = Union[int, str, None]


class Scene:
    """A scene as read: immutable; `with_` gives a changed copy. In a notebook it shows its drawing.

    Speeds are `rpm` (revolutions per minute) or `omega` (rad per the scene's unit of time), plain or as texts with a unit
    ("50 Hz"); what is left out is taken from the scene's [analysis]. All arguments are by name; what cannot be asked is an hb.RequestError.
    """

    def __init__(self, text: str, *, name: str = "text", folder: Union[str, "os.PathLike[str]"] = ".") -> None:
        self._core = _core.Scene(text, name, os.fspath(folder))

    @classmethod
    def _of(cls, core: _core.Scene) -> "Scene":
        scene = cls.__new__(cls)
        scene._core = core
        return scene

    @classmethod
    def from_dict(cls, scene: Mapping[str, Any], *, folder: Union[str, "os.PathLike[str]"] = ".") -> "Scene":
        """A scene given by its keys, as tables and lists in Python; relative paths of files are taken from folder."""
        return cls(toml_text.document(scene), name="dict", folder=folder)

    def to_dict(self) -> dict[str, Any]:
        """The scene's keys, as from_dict takes them (needs Python 3.11)."""
        import tomllib

        return tomllib.loads(self.text)

    def with_(self, changes: Optional[Mapping[str, Any]] = None) -> "Scene":
        """A copy with some numbers replaced, by their paths: {"AB.J": 60, "*.damping_internal": 2e-4, "gravity": 0}.
        Values are numbers, texts with units ("210 GPa"), or lists."""
        if changes is None:
            return self
        if not isinstance(changes, Mapping):
            raise refused("changes", changes, 'a dict, as in {"AB.J": 60}')
        pairs = []
        for path, value in changes.items():
            if not isinstance(path, str):
                raise refused("changes", path, "paths as texts")
            pairs.append((path, toml_text.value(value, path)))
        return Scene._of(self._core.changed(pairs))

    @property
    def text(self) -> str:
        """The scene's file (TOML)."""
        return self._core.text

    @property
    def name(self) -> str:
        """The file's name as given, "text" or "dict"."""
        return self._core.name

    @property
    def title(self) -> str:
        """The scene's title."""
        return self._core.title

    @property
    def units(self) -> dict[str, str]:
        """Names of the units of length, mass, time and angle."""
        return self._core.units

    @property
    def rods(self) -> list[str]:
        """Names of the elastic links; ["system"] of a [hill] scene."""
        return self._core.rods

    @property
    def warnings(self) -> list[str]:
        """What is odd, but usable; the gravest first."""
        return self._core.warnings

    @property
    def notes(self) -> list[str]:
        """Remarks that do not touch the answer."""
        return self._core.notes

    @property
    def paths(self) -> list[str]:
        """Paths of all numbers that the scene gives."""
        return self._core.paths()

    def __getitem__(self, path: str) -> float:
        """The number at a path, in the scene's units."""
        if not isinstance(path, str):
            raise refused("path", path, "a text, as in \"AB.J\"")
        return self._core.value(path)

    def understood(self) -> dict[str, Any]:
        """The document of `hb scene --json`: what the program understood."""
        document: dict[str, Any] = json.loads(self._core.json())
        return document

    def steady(
        self,
        *,
        rpm: Speed = None,
        omega: Speed = None,
        modes: Modes = None,
        tol: Optional[float] = None,
        rods: Names = None,
        only: Names = None,
        theory: str = "linear",
        period: Optional[int] = None,
        steady_method: Optional[str] = None,
        stability_method: Optional[str] = None,
        bound: Optional[str] = None,
        band: Any = None,
        time_limit: Optional[float] = None,
    ) -> "Steady":
        """The periodic steady state at one speed, its stability, joint forces and torque: hb.Steady.

        modes: Ritz terms per elastic link, 1 to 60, or "auto". tol: relative error wanted. rods: names of links to look
        at. only: of "steady", "stability", "growth", "verdict", "reactions", "shape". theory: "linear" or "nonlinear" (the motion
        without linearisation, all rods together), with period: motions of so many turns. bound: "estimated" or "proved".
        band: {"damping": (0.5, 2), "E": (0.9, 1.1), "mass": (0.9, 1.1)}, factors between which the answer is computed once
        more, or the command's texts: `bands` of the answer. time_limit: seconds; TimeoutError where there is no answer by then.
        """
        from .steady import Steady

        arguments = {
            "rpm": rpm,
            "omega": omega,
            "modes": modes,
            "tol": tol,
            "rods": rods,
            "only": only,
            "theory": theory,
            "period": period,
            "steady_method": steady_method,
            "stability_method": stability_method,
            "bound": bound,
            "band": _band_texts(band),
            "time_limit": time_limit,
        }
        return Steady(self, arguments, _core.steady(self._core, arguments))

    def sweep(
        self,
        *,
        rpm: Any = None,
        omega: Any = None,
        x: Any = None,
        modes: Modes = None,
        tol: Optional[float] = None,
        rods: Names = None,
        only: Names = None,
        theory: str = "linear",
        period: Optional[int] = None,
        search: bool = True,
        band: Any = None,
        steady_method: Optional[str] = None,
        stability_method: Optional[str] = None,
        threads: Union[int, str] = 1,
        time_limit: Optional[float] = None,
        progress: Progress = False,
    ) -> "Sweep":
        """Along the speed or any other number, with resonance peaks and unstable bands located: hb.Sweep.

        rpm (or omega): a range (from, to, step), "FROM:TO:STEP", "FROM:TO:xN" (N points; "5 Hz:50 Hz:x10"), or an array
        of values. x: a number of the scene instead, "AB.J=30:60:1" or ("AB.J", range), at one rpm or omega. theory: "nonlinear" adds the
        branches of the motion without linearisation, of up to `period` turns. search: False leaves out what lies
        between the points (bands, resonance peaks), as only="growth" or "verdict" does for bands. threads: 1 or more, or
        "all"; the answer has the same bits. time_limit: seconds; the answer is then what is there, and `shortfalls` says
        so. band: as in steady(): `bands` of the answer. progress: True, or a function of
        (what, done, total).
        """
        from .sweep import Sweep

        arguments = {
            "rpm": rpm,
            "omega": omega,
            "x": x,
            "modes": modes,
            "tol": tol,
            "rods": rods,
            "only": only,
            "theory": theory,
            "period": period,
            "search": search,
            "band": _band_texts(band),
            "steady_method": steady_method,
            "stability_method": stability_method,
            "threads": threads,
            "time_limit": time_limit,
        }
        return Sweep(self, arguments, _long(_core.sweep, self, arguments, progress))

    def map(
        self,
        *,
        x: Any,
        y: Any,
        rpm: Speed = None,
        omega: Speed = None,
        modes: Modes = None,
        tol: Optional[float] = None,
        rods: Names = None,
        only: Names = None,
        damping_range: Any = None,
        band: Any = None,
        boundaries: bool = True,
        boundary_tol: Optional[float] = None,
        stress: bool = False,
        stability_method: Optional[str] = None,
        threads: Union[int, str] = 1,
        time_limit: Optional[float] = None,
        progress: Progress = False,
    ) -> "Map":
        """Stability over two numbers, one of which may be the speed: hb.Map.

        x, y: "PATH=FROM:TO:COUNT" as in "rpm=200:6000:117" or "*.J=20:200:61", or (path, range) with a range
        (from, to, count) or an array of values. damping_range: a pair of factors on the damping; boundaries with either are
        in `damping`. band: one of {"E": (0.9, 1.1)}, "mass=0.9:1.1", damping: boundaries at both ends in `band`.
        boundaries: False computes the grid alone. boundary_tol: relative error
        wanted of boundary points, 1e-14 to 0.01. stress: also stress, safety and deflection of links with a section, in
        `mp["AB"].stress` and `.deflection`. only: "stability", "growth" or "verdict". Other arguments as in sweep().
        """
        from .map import Map

        arguments = {
            "x": x,
            "y": y,
            "rpm": rpm,
            "omega": omega,
            "modes": modes,
            "tol": tol,
            "rods": rods,
            "only": only,
            "damping_range": damping_range,
            "band": _band_texts(band),
            "boundaries": boundaries,
            "boundary_tol": boundary_tol,
            "stress": stress or None,
            "stability_method": stability_method,
            "threads": threads,
            "time_limit": time_limit,
        }
        return Map(self, arguments, _long(_core.map, self, arguments, progress))

    def check(
        self,
        *,
        rpm: Any = None,
        omega: Any = None,
        modes: Modes = None,
        tol: Optional[float] = None,
        rods: Names = None,
        only: Names = None,
        integrator: Optional[str] = None,
        case_limit: Optional[float] = None,
        march: bool = False,
        theory: str = "linear",
        period: Optional[int] = None,
        threads: Union[int, str] = 1,
        time_limit: Optional[float] = None,
        progress: Progress = False,
    ) -> "Check":
        """The same by time integration on an independent path, at one speed or a range: hb.Check.

        integrator: "automatic", "adams", "bdf" or "collocation". case_limit: seconds for each rod and speed (60).
        march: also march from rest until the transient has died out.
        """
        from .check import Check

        arguments = {
            "rpm": rpm,
            "omega": omega,
            "modes": modes,
            "tol": tol,
            "rods": rods,
            "only": only,
            "integrator": integrator,
            "case_limit": case_limit,
            "march": bool(march),
            "theory": theory,
            "period": period,
            "threads": threads,
            "time_limit": time_limit,
        }
        return Check(self, arguments, _long(_core.check, self, arguments, progress))

    def bench(
        self,
        *,
        rpm: Speed = None,
        omega: Speed = None,
        modes: Modes = None,
        rods: Names = None,
        steady_method: Optional[str] = None,
        case_limit: Optional[float] = None,
        theory: str = "linear",
        period: Optional[int] = None,
        time_limit: Optional[float] = None,
        progress: Progress = False,
    ) -> "Bench":
        """Error against run time of the periodic state at one speed, for every method: hb.Bench.

        Every method runs on one thread at its own list of tolerances. case_limit: seconds for each case (5).
        """
        from .bench import Bench

        arguments = {
            "rpm": rpm,
            "omega": omega,
            "modes": modes,
            "rods": rods,
            "steady_method": steady_method,
            "case_limit": case_limit,
            "theory": theory,
            "period": period,
            "time_limit": time_limit,
        }
        return Bench(self, arguments, _long(_core.bench, self, arguments, progress))

    def tune(
        self,
        *,
        minimise: Optional[str] = None,
        maximise: Optional[str] = None,
        vary: Any,
        keep: Names = None,
        over: Any = None,
        rpm: Any = None,
        omega: Any = None,
        tie: Any = None,
        height: Any = None,
        modes: Modes = None,
        tol: Optional[float] = None,
        rods: Names = None,
        algorithm: Optional[str] = None,
        seed: Optional[int] = None,
        analyses: Optional[int] = None,
        speeds: Optional[int] = None,
        threads: Union[int, str] = 1,
        time_limit: Optional[float] = None,
        progress: Progress = False,
    ) -> "Tune":
        """A design: numbers of the scene that are best by a goal under conditions, worst over the speeds: hb.Tune.

        minimise: "mass", "deflection", "stress", "total-stress", "force", "torque-ripple", or a sum
        "0.7*deflection+0.3*mass"; maximise: "stable", "safety", "frequency", "clearance:N" or "speed-range".
        vary: {path: (from, to)}. keep: conditions such as "stable>=5", "safety>=1.5". over: (from, to) in rpm, or
        "omega=FROM:TO". tie: {path: path} or {path: (factor, path)}. height: {rod: height} for stresses and safety.
        """
        from .tune import Tune

        arguments = {
            "minimise": minimise,
            "maximise": maximise,
            "vary": vary,
            "keep": keep,
            "over": over,
            "rpm": rpm,
            "omega": omega,
            "tie": tie,
            "height": height,
            "modes": modes,
            "tol": tol,
            "rods": rods,
            "algorithm": algorithm,
            "seed": seed,
            "analyses": analyses,
            "speeds": speeds,
            "threads": threads,
            "time_limit": time_limit,
        }
        return Tune(self, arguments, _long(_core.tune, self, arguments, progress))

    def report(
        self,
        file: Any,
        *,
        rpm: Any = None,
        omega: Any = None,
        x: Any = None,
        y: Any = None,
        pictures: bool = True,
        threads: Union[int, str] = 1,
        progress: Progress = False,
        **arguments: Any,
    ) -> None:
        """Writes one self-contained HTML page that moves: a sweep, and with x and y a map beside it; as `hb report`.

        pictures: for readers without script, where gnuplot is there. Other arguments as in sweep().
        """
        from .reports import scene

        sweep = self.sweep(rpm=rpm, omega=omega, threads=threads, progress=progress, **arguments)
        both = x is not None or y is not None
        of_map = {k: v for k, v in arguments.items() if k in ("modes", "tol", "rods", "stability_method")}
        map = self.map(x=x, y=y, threads=threads, progress=progress, **of_map) if both else None
        scene(self, sweep, map, file, pictures=pictures, threads=threads)

    def plot(self, ax: Optional["Axes"] = None) -> "Axes":
        """Draws the mechanism: crank angle 0 dark, other poses light, paths of the joints."""
        from . import plots

        return plots.scene(self, ax)

    def __repr__(self) -> str:
        rods = ", ".join(self.rods)
        return f"<hb.Scene {self.title or self.name!r}: {rods or 'no elastic link'}>"

    def __str__(self) -> str:
        return self._core.table()

    def _repr_svg_(self) -> Optional[str]:
        return self._core.drawing() or None

    def _repr_html_(self) -> str:
        from .reports import preformatted

        return self._core.drawing() + preformatted(str(self))

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self._core.text, self._core.name, self._core.folder)


def _band_texts(band: Any) -> Any:
    """The command's texts of {"E": (0.9, 1.1)}; texts as they are."""
    return [f"{name}={low!r}:{high!r}" for name, (low, high) in band.items()] if isinstance(band, Mapping) else band


def _again(text: str, name: str, folder: str) -> Scene:
    return Scene(text, name=name, folder=folder)


def _long(function: Any, scene: Scene, arguments: dict[str, Any], progress: Progress) -> Any:
    try:
        return function(scene._core, arguments, teller(progress))
    finally:
        finish(progress)


def load(file: Union[str, "os.PathLike[str]"]) -> Scene:
    """Reads a scene from a file; hb.SceneError names file, line, key, what was found and what is allowed."""
    try:
        path = os.fspath(file)
    except TypeError:
        raise refused("file", file, "a path") from None
    if not isinstance(path, str) or "\0" in path:
        raise refused("file", path, "a path as text")
    return Scene._of(_core.Scene.load(path))


def loads(text: str, *, name: str = "text", folder: Union[str, "os.PathLike[str]"] = ".") -> Scene:
    """Reads a scene from text; `name` stands in messages, relative paths of files are taken from `folder`."""
    return Scene(text, name=name, folder=folder)
