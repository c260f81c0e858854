"""Stability over two numbers of a scene."""

from __future__ import annotations

from copy import deepcopy
from functools import cached_property
from typing import TYPE_CHECKING, Any, Optional

from . import _core
from .machine_loads import Stress, made
from .result import Result, floats, words

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray


class Boundary:
    """A curve on which the verdict changes."""

    def __init__(self, entry: dict[str, Any]) -> None:
        self._entry = entry

    @property
    def kind(self) -> str:
        """How the leading exponent leaves: "+1", "-1" (period doubling) or "complex"."""
        return str(self._entry["kind"])

    @property
    def rod(self) -> Optional[str]:
        """The elastic link whose boundary it is."""
        return self._entry.get("rod")

    @property
    def closed(self) -> bool:
        """Whether the last point repeats the first."""
        return bool(self._entry["closed"])

    @property
    def error(self) -> float:
        """Largest error of a point, along x or y."""
        return float(self._entry["error"])

    @cached_property
    def points(self) -> "NDArray[Any]":
        """(points, 2): x and y."""
        return floats(self._entry["points"]).reshape(-1, 2)

    def to_dict(self) -> dict[str, Any]:
        """Its entry in the document."""
        return dict(self._entry)

    def __repr__(self) -> str:
        return f"<hb.Boundary {self.kind}: {len(self._entry['points'])} points>"


class _Grid:
    _entry: dict[str, Any]

    @cached_property
    def growth_rate(self) -> "NDArray[Any]":
        """Growth rate, 1/time, (len(y), len(x)); NaN where there is no system."""
        return floats(self._entry["growth_rate"])

    @cached_property
    def growth_error(self) -> "NDArray[Any]":
        """Its error; NaN where the growth rate itself was interpolated (several modes)."""
        return floats(self._entry["growth_error"])

    @cached_property
    def verdict(self) -> "NDArray[Any]":
        """"stable", "bounded", "unstable" or "undecided", (len(y), len(x)); None where there is no system."""
        return words(self._entry["verdict"])

    @cached_property
    def kind(self) -> "NDArray[Any]":
        """Kind of the leading exponent: "+1", "-1" or "complex"."""
        return words(self._entry["kind"])

    @property
    def boundaries(self) -> list[Boundary]:
        """Curves on which the verdict changes, refined to the tolerance; none where they were not asked for."""
        return [Boundary(entry) for entry in self._entry.get("boundaries", [])]


class RodMap(_Grid):
    """The map of one elastic link by itself."""

    def __init__(self, name: str, entry: dict[str, Any]) -> None:
        self.name = name
        self._entry = entry

    @cached_property
    def stress(self) -> Optional[Stress]:
        """With map(stress=True): max_abs, mean, amplitude, error and safeties, (len(y), len(x)); else None."""
        return made(Stress, self._entry.get("stress"), floats)

    @cached_property
    def deflection(self) -> "Optional[NDArray[Any]]":
        """With map(stress=True): largest deflection over rod and turn."""
        entry = self._entry.get("deflection")
        return None if entry is None else floats(entry)

    @cached_property
    def theory_error(self) -> "Optional[NDArray[Any]]":
        """With map(stress=True): what the first nonlinear correction would change of q; NaN where it has no value."""
        entry = self._entry.get("theory_error")
        return None if entry is None else floats(entry)

    def __repr__(self) -> str:
        return f"<hb.RodMap {self.name}: {len(self.boundaries)} boundaries>"


class Map(_Grid, Result):
    """Growth rate and verdict of the worst elastic link on a grid, and the boundaries; `mp["AB"]` is one link alone."""

    def __init__(self, scene: Any, arguments: dict[str, Any], core: _core.Map) -> None:
        Result.__init__(self, scene, arguments, core)
        self._entry = self._document

    def _computed(self) -> _core.Map:
        return _core.map(self._scene._core, self._arguments, None)

    @property
    def x_path(self) -> str:
        """What x is: "rpm", "omega" or a path."""
        return str(self._document["x"]["path"])

    @property
    def y_path(self) -> str:
        """What y is."""
        return str(self._document["y"]["path"])

    @cached_property
    def x(self) -> "NDArray[Any]":
        """Values along x."""
        return floats(self._document["x"]["values"])

    @cached_property
    def y(self) -> "NDArray[Any]":
        """Values along y."""
        return floats(self._document["y"]["values"])

    @property
    def rods(self) -> dict[str, RodMap]:
        """The maps of the elastic links by name."""
        return {name: RodMap(name, entry) for name, entry in self._document["rods"].items()}

    @property
    def damping(self) -> dict[float, list[Boundary]]:
        """With damping_range: for each factor on the damping the boundaries of the worst link."""
        entries = self._document.get("damping_range", [])
        return {float(entry["factor"]): [Boundary(curve) for curve in entry["boundaries"]] for entry in entries}

    @property
    def band(self) -> dict[float, list[Boundary]]:
        """With band: for each factor the boundaries of the worst link; those of damping too."""
        entries = self._document.get("band", []) or self._document.get("damping_range", [])
        return {float(entry["factor"]): [Boundary(curve) for curve in entry["boundaries"]] for entry in entries}

    @property
    def theory_sample(self) -> Any:
        """Theory errors at some places, corners included: x, y, theory_error by link, growth_theory_error (None in
        them: no value), and whether a link is beyond the linear theory there. None for a HillSystem, and where q was not asked for."""
        return deepcopy(self._document.get("theory_sample"))

    @property
    def shortfalls(self) -> list[str]:
        """What missed a boundary_tol asked for, or was not computed in time."""
        notes = list(self._document.get("notes", []))
        asked = self._arguments.get("boundary_tol") is not None
        missed = asked and self._document.get("boundary_points_not_reached", 0) > 0
        early = self._document["status"] != "reached"
        return (notes[:1] if early else []) + (notes[-1:] if missed else [])

    def to_frame(self) -> "pandas.DataFrame":
        """The command's table map_grid.csv: a row for each place."""
        from . import frames

        return frames.of_table(self._core.table())

    def to_xarray(self) -> "xarray.Dataset":
        """Growth rate and verdict as an xarray Dataset over (y, x)."""
        from . import frames

        return frames.map_dataset(self)

    def plot(self, ax: Optional["Axes"] = None) -> "Axes":
        """Draws growth rate, boundaries by kind and resonance lines."""
        from . import plots

        return plots.map(self, ax)

    def report(self, file: Any) -> None:
        """Writes one self-contained HTML page."""
        from .reports import map

        map(self, file)

    def __getitem__(self, name: str) -> RodMap:
        rods = self._document["rods"]
        if name in rods:
            return RodMap(name, rods[name])
        raise KeyError(f"{name}: no elastic link here; there are {', '.join(rods)}")

    def __repr__(self) -> str:
        shape = f"{len(self.x)} x {len(self.y)}"
        return f"<hb.Map of {self._scene.name} over {self.x_path} and {self.y_path}: {shape} places>"
