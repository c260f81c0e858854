"""A scene at one speed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Optional

from . import _core
from ._core import Force, Rod, Stability

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes

    from .scene import Scene


class _Forces(dict[str, Force]):
    def __missing__(self, name: object) -> Force:
        raise KeyError(f"{name}: no joint here; there are {', '.join(self) or 'none'}")


class Steady:
    """The periodic motion at one speed: responses and stability of the elastic links, forces and torque.

    `s["AB"]` is one elastic link (hb.Rod), `s.joints["AB.0"]` a joint's force, `s.torque` the driving torque (hb.Force).
    """

    def __init__(self, scene: "Scene", arguments: dict[str, Any], answer: _core.Answer) -> None:
        self._scene = scene
        self._arguments = arguments
        self._answer = answer
        answer.origin = (_answer, (scene, arguments))
        self._rods: dict[str, Rod] = answer.rods()
        self._joints = _Forces(answer.joints())
        self._document: Optional[dict[str, Any]] = None

    @property
    def scene(self) -> "Scene":
        """The scene that was asked."""
        return self._scene

    @property
    def omega(self) -> float:
        """Speed of the crank, rad per the scene's unit of time."""
        return self._answer.omega

    @property
    def rpm(self) -> float:
        """Speed of the crank, revolutions per minute."""
        rpm: float = self._doc["rpm"]
        return rpm

    @property
    def rods(self) -> Mapping[str, Rod]:
        """Elastic links by name."""
        return MappingProxyType(self._rods)

    @property
    def joints(self) -> Mapping[str, Force]:
        """Joint forces by the joint's name ("AB.0", "O2BC.pivot", "piston.guide"); empty where not computed."""
        return MappingProxyType(self._joints)

    @property
    def torque(self) -> Optional[Force]:
        """The driving torque; None where not computed."""
        return self._answer.torque()

    @property
    def system(self) -> Optional[Stability]:
        """Stability of all rods together, of a motion without linearisation; else None."""
        return self._answer.stability

    @property
    def verdict(self) -> Optional[str]:
        """The worst of all elastic links: "unstable", "undecided", "bounded" or "stable"."""
        return self._answer.verdict

    @property
    def converged(self) -> bool:
        """Whether everything reached the tolerance asked for; if not, `shortfalls` says what did not."""
        return not self._answer.shortfalls

    @property
    def shortfalls(self) -> list[str]:
        """One sentence for each thing that missed its tolerance."""
        return self._answer.shortfalls

    @property
    def warnings(self) -> list[str]:
        """What is odd about the scene, and where the answer is beyond the linear theory."""
        return list(self._doc.get("warnings", []))

    @property
    def _doc(self) -> dict[str, Any]:
        if self._document is None:
            self._document = json.loads(self._answer.json())
        return self._document

    def to_dict(self) -> dict[str, Any]:
        """The document of `hb steady --json`."""
        document: dict[str, Any] = json.loads(self._answer.json())
        return document

    def to_frame(self, what: str = "response") -> "pandas.DataFrame":
        """A table of the command as a pandas DataFrame: "response", "fourier", "deflection", "bending_moment" or
        "exponents" of all rods, "joint_forces", or "torque"; units stand in the columns' names."""
        from . import frames

        return frames.of_steady(self, what)

    def to_xarray(self) -> "xarray.Dataset":
        """Responses and forces over one turn as an xarray Dataset, in the units of to_frame()."""
        from . import frames

        return frames.steady_dataset(self)

    def plot(self, rod: Optional[str] = None, kind: str = "response", ax: Optional["Axes"] = None) -> "Axes":
        """Draws one rod (default: the first): "response", "spectrum", "phase", "deflection", "bending_moment" or
        "exponents"; or "torque" of the crank."""
        from . import plots

        return plots.steady(self, rod, kind, ax)

    def report(self, file: Any) -> None:
        """Writes one self-contained HTML page that moves."""
        from .reports import steady

        steady(self, file)

    def __getitem__(self, name: str) -> Rod:
        if name in self._rods:
            return self._rods[name]
        raise KeyError(f"{name}: no elastic link here; there are {', '.join(self._rods) or 'none'}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._rods)

    def __len__(self) -> int:
        return len(self._rods)

    def __contains__(self, name: object) -> bool:
        return name in self._rods

    def __repr__(self) -> str:
        verdict = f", {self.verdict}" if self.verdict else ""
        return f"<hb.Steady of {self._scene.name} at {self.rpm:g} rpm: {', '.join(self._rods)}{verdict}>"

    def __str__(self) -> str:
        return self._answer.words()

    def _repr_html_(self) -> str:
        from .reports import preformatted

        return preformatted(str(self))

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self._scene, self._arguments)


def _answer(scene: "Scene", arguments: dict[str, Any]) -> _core.Answer:
    return _core.steady(scene._core, arguments)


def _again(scene: "Scene", arguments: dict[str, Any]) -> Steady:
    return Steady(scene, arguments, _answer(scene, arguments))


def _rod_to_dict(self: Rod) -> dict[str, Any]:
    """Its entry under "rods" of `hb steady --json`."""
    document: dict[str, Any] = json.loads(self._owner.json())["rods"][self.name]
    return document


def _rod_reduce(self: Rod) -> tuple[Any, ...]:
    return _rod_again, (*self._owner.origin, self._index)


def _rod_again(function: Any, arguments: tuple[Any, ...], index: int) -> Rod:
    answer: _core.Answer = function(*arguments)
    answer.origin = (function, arguments)
    return answer.rod(index)


def _rod_plot(self: Rod, kind: str = "response", ax: Optional["Axes"] = None) -> "Axes":
    """Draws "response", "spectrum", "phase", "deflection", "bending_moment" or "exponents"."""
    from . import plots

    return plots.rod(self, kind, ax)


def _rod_to_frame(self: Rod, what: str = "response") -> "pandas.DataFrame":
    """A table of the command: "response", "fourier", "deflection", "bending_moment" or "exponents"."""
    from . import frames

    return frames.of_table(self._table(what))


for _name, _function in {
    "to_dict": _rod_to_dict,
    "to_frame": _rod_to_frame,
    "plot": _rod_plot,
    "__reduce__": _rod_reduce,
}.items():
    _function.__name__ = _name
    _function.__qualname__ = f"Rod.{_name}"
    setattr(Rod, _name, _function)
