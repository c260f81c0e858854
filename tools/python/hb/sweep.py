"""A scene along one of its numbers."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from functools import cached_property
from typing import TYPE_CHECKING, Any, Optional

from . import _core
from .result import Result, floats, padded, words

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from .machine_loads import Bearing, Flywheel, Frame, Power, Stress, Torque


class CriticalPoint(dict[str, Any]):
    """A resonance peak, with the keys of the command's document as attributes too; float() of it is its place."""

    def __getattr__(self, key: str) -> Any:
        try:
            return self[key]
        except KeyError:
            raise AttributeError(key) from None

    def __float__(self) -> float:
        return float(self["x"])


class SweepRod:
    """One elastic link along the axis: arrays have a row for each point; NaN (or None) where there is no linkage or
    the quantity was not computed."""

    def __init__(self, sweep: "Sweep", name: str) -> None:
        self._sweep = sweep
        self.name = name

    @property
    def _entry(self) -> dict[str, Any]:
        entry: dict[str, Any] = self._sweep._document["rods"][self.name]
        return entry

    def _list(self, key: str) -> list[Any]:
        return self._entry.get(key) or [None] * len(self._sweep)

    @property
    def modes(self) -> int:
        """Number of Ritz terms I."""
        return int(self._entry["modes"])

    @cached_property
    def max_abs(self) -> "NDArray[Any]":
        """Largest |q_i| over the turn, (points, I)."""
        return padded(self._list("max_abs"))

    @cached_property
    def error_bound(self) -> "NDArray[Any]":
        """Bound on the relative error of q, (points,)."""
        return floats(self._list("error_bound"))

    @cached_property
    def theory_error(self) -> "NDArray[Any]":
        """Relative error of the linear theory, (points,)."""
        return floats(self._list("theory_error"))

    @cached_property
    def deflection_theory_error(self) -> "NDArray[Any]":
        """Relative error of the linear theory of the deflection, (points,)."""
        return floats(self._list("deflection_theory_error"))

    @cached_property
    def deflection(self) -> "NDArray[Any]":
        """Largest deflection over rod and turn, (points,)."""
        return floats(self._list("deflection"))

    @cached_property
    def deflection_error(self) -> "NDArray[Any]":
        """Estimated error of the deflection, modes left out included, (points,)."""
        return floats(self._list("deflection_error"))

    @cached_property
    def bending_moment_error(self) -> "NDArray[Any]":
        """Estimated error of the bending moment, modes left out included, (points,)."""
        return floats(self._list("bending_moment_error"))

    @cached_property
    def buckling_share_error(self) -> "NDArray[Any]":
        """Error of buckling_share, (points,)."""
        return floats(self._list("buckling_share_error"))

    @cached_property
    def bending_moment(self) -> "NDArray[Any]":
        """Largest bending moment over rod and turn, (points,)."""
        return floats(self._list("bending_moment"))

    @cached_property
    def resonance_distance(self) -> "NDArray[Any]":
        """Smallest singular value of the scaled balance, (points,): 0 at a resonance."""
        return floats(self._list("resonance_distance"))

    @cached_property
    def buckling_share(self) -> "NDArray[Any]":
        """Largest push over the rod's buckling load, (points,)."""
        return floats(self._list("buckling_share"))

    @cached_property
    def strain(self) -> "NDArray[Any]":
        """Largest strain, axial and bending added, (points,)."""
        return floats(self._list("strain"))

    @cached_property
    def stress(self) -> "Optional[Stress]":
        """max_abs, mean, amplitude, yield_safety, fatigue_safety as arrays, (points,); None where the scene gives no
        `section`, or shapes were not computed."""
        from .machine_loads import Stress, made

        return made(Stress, self._entry.get("stress"), floats)

    @cached_property
    def distance_to_boundary(self) -> "NDArray[Any]":
        """To the nearest end of an unstable band of this rod, along the axis, (points,); NaN where there is none."""
        return floats(self._list("distance_to_boundary"))

    @cached_property
    def growth_rate(self) -> "NDArray[Any]":
        """Largest real part of the exponents, 1/time, (points,)."""
        return floats(self._list("growth_rate"))

    @cached_property
    def growth_error(self) -> "NDArray[Any]":
        """Error of the growth rate, (points,)."""
        return floats(self._list("growth_error"))

    @cached_property
    def verdict(self) -> "NDArray[Any]":
        """"stable", "bounded", "unstable" or "undecided", (points,)."""
        return words(self._list("verdict"))

    @cached_property
    def exponents(self) -> "NDArray[Any]":
        """Floquet exponents, complex, (points, as many as were resolved anywhere); NaN beyond those of a point."""
        return padded(self._list("exponents"), complex_pairs=True)

    def _searched(self, key: str) -> Optional[list[Any]]:
        found: Optional[list[Any]] = self._sweep._document.get(key, {}).get(self.name)
        return deepcopy(found)

    @property
    def unstable_bands(self) -> Optional[list[list[float]]]:
        """[from, to] of each unstable band; None where they were not looked for."""
        return self._searched("unstable_bands")

    @property
    def not_excluded(self) -> Optional[list[list[float]]]:
        """[from, to] of each place where further bands or gaps are not excluded; None where they were not looked for."""
        return self._searched("not_excluded")

    @property
    def band_details(self) -> Optional[list[dict[str, Any]]]:
        """The bands with kind and error of their ends and the fastest growth inside."""
        return self._searched("band_details")

    def to_dict(self) -> dict[str, Any]:
        """Its entry under "rods" of the document."""
        entry: dict[str, Any] = self._sweep.to_dict()["rods"][self.name]
        return entry

    def to_frame(self) -> "pandas.DataFrame":
        """The command's table sweep_ROD.csv: all points, also those between, with frequencies and growth of all modes."""
        from . import frames

        return frames.of_table(self._sweep._core.rod_table(self.name))

    def plot(self, kind: str = "campbell", ax: Optional["Axes"] = None) -> "Axes":
        """Draws "campbell", "growth", "peaks", "deflection" or "branches" along the axis, unstable bands shaded."""
        from . import plots

        return plots.sweep_rod(self, kind, ax)

    def __repr__(self) -> str:
        bands = "no search for" if self.unstable_bands is None else len(self.unstable_bands)
        return f"<hb.SweepRod {self.name}: {self.modes} modes, {bands} unstable bands>"


class Sweep(Result):
    """A scene along the speed or another number: `sw["AB"]` is one elastic link (hb.SweepRod)."""

    def __init__(self, scene: Any, arguments: dict[str, Any], core: _core.Sweep) -> None:
        super().__init__(scene, arguments, core)
        self._missed: list[str] = core.shortfalls
        self._rods = {name: SweepRod(self, name) for name in self._document["rods"]}

    def _computed(self) -> _core.Sweep:
        return _core.sweep(self._scene._core, self._arguments, None)

    @property
    def path(self) -> str:
        """What it goes along: "rpm", "omega" or a path."""
        return str(self._document["x"]["path"])

    @property
    def status(self) -> str:
        """"reached", or "tolerance not reached"."""
        return str(self._document["status"])

    @cached_property
    def x(self) -> "NDArray[Any]":
        """Values along the axis, (points,)."""
        return floats(self._document["x"]["values"])

    @cached_property
    def rpm(self) -> "NDArray[Any]":
        """Speed at each point."""
        return floats(self._document["rpm"])

    @cached_property
    def omega(self) -> "NDArray[Any]":
        """Speed at each point, rad per unit time."""
        return floats(self._document["omega"])

    @cached_property
    def verdict(self) -> Optional["NDArray[Any]"]:
        """The worst of all elastic links at each point; None where stability was not asked for."""
        return words(self._document["verdict"]) if "verdict" in self._document else None

    @property
    def critical(self) -> list[CriticalPoint]:
        """Resonance peaks, located."""
        return [CriticalPoint(point) for point in self._document.get("critical", [])]

    @cached_property
    def critical_rpm(self) -> "NDArray[Any]":
        """Speeds of resonance peaks in rpm; empty where the axis is no speed."""
        return floats(self._document.get("critical_rpm", []))

    @cached_property
    def critical_x(self) -> "NDArray[Any]":
        """Places of resonance peaks along the axis."""
        return floats(self._document.get("critical_x", []))

    @property
    def bands(self) -> list[dict[str, Any]]:
        """With band=...: of each what hb sweep --json has, `parameter`, `from`, `to`, and `at_from`, `at_to` with verdicts
        and the arrays of each rod; else empty."""
        return list(self._document.get("bands", []))

    @property
    def unstable_bands(self) -> dict[str, Optional[list[list[float]]]]:
        """[from, to] of each unstable band, by rod."""
        return {name: rod.unstable_bands for name, rod in self._rods.items()}

    @property
    def not_excluded(self) -> dict[str, Optional[list[list[float]]]]:
        """[from, to] of each place where further bands or gaps are not excluded, by rod."""
        return {name: rod.not_excluded for name, rod in self._rods.items()}

    @property
    def band_details(self) -> dict[str, Optional[list[dict[str, Any]]]]:
        """The unstable bands with kind and error of their ends and the fastest growth inside, by rod."""
        return {name: rod.band_details for name, rod in self._rods.items()}

    @property
    def branches(self) -> list[dict[str, Any]]:
        """Of the motion without linearisation, along the arc, with the keys of the document; else empty."""
        return [dict(branch) for branch in self._document.get("branches", [])]

    @cached_property
    def folds(self) -> "NDArray[Any]":
        """Where a branch turns back, along the axis (a speed in rpm)."""
        return floats(self._document.get("folds", []))

    @property
    def bifurcations(self) -> list[dict[str, Any]]:
        """Where branches of the motion without linearisation meet or lose their stability."""
        return [dict(event) for event in self._document.get("bifurcations", [])]

    @property
    def shortfalls(self) -> list[str]:
        """One sentence for each thing that missed its tolerance."""
        return list(self._missed)

    @property
    def joints(self) -> dict[str, Any]:
        """Smallest and largest joint forces at each point, as in the document."""
        return dict(self._document.get("joints", {}))

    @cached_property
    def torque(self) -> "Optional[Torque]":
        """Driving torque: min, max, mean, rms, (points,), and `rigid` with min and max; None where not computed."""
        from .machine_loads import Torque, made

        return made(Torque, self._document.get("torque"), floats)

    def _of_mechanism(self, key: str) -> "NDArray[Any]":
        return floats(self._document.get(key) or [None] * len(self))

    @cached_property
    def joints_error(self) -> "NDArray[Any]":
        """Estimated error of joint forces for the modes kept, relative to the largest, (points,); NaN: not computed."""
        return self._of_mechanism("joints_error")

    @cached_property
    def torque_error(self) -> "NDArray[Any]":
        """The same of the torque, (points,)."""
        return self._of_mechanism("torque_error")

    @cached_property
    def joints_modes_error(self) -> "NDArray[Any]":
        """Estimated error of joint forces from the modes left out, relative to the largest, (points,)."""
        return self._of_mechanism("joints_modes_error")

    @cached_property
    def torque_modes_error(self) -> "NDArray[Any]":
        """The same of the torque, (points,)."""
        return self._of_mechanism("torque_modes_error")

    @cached_property
    def joints_theory_error(self) -> "NDArray[Any]":
        """What the linear theory leaves out of the joint forces, of the largest, (points,); NaN: none, or not computed."""
        return self._of_mechanism("joints_theory_error")

    @cached_property
    def torque_theory_error(self) -> "NDArray[Any]":
        """The same of the driving torque, (points,)."""
        return self._of_mechanism("torque_theory_error")

    @cached_property
    def growth_theory_error(self) -> "NDArray[Any]":
        """What the nonlinear correction changes of the mechanism's growth rate, 1/time, (points,)."""
        return self._of_mechanism("growth_theory_error")

    @cached_property
    def bearings(self) -> "dict[str, Bearing]":
        """Largest resultant at each joint: `max`, (points,); empty where joint forces were not computed."""
        from .machine_loads import Bearing, made_by_name

        return made_by_name(Bearing, self._document.get("bearings"), floats)

    @cached_property
    def frame(self) -> "Optional[Frame]":
        """Largest shaking force, `max`, and `moment`, (points,); None where not computed."""
        from .machine_loads import Frame, made

        return made(Frame, self._document.get("frame"), floats)

    @cached_property
    def power(self) -> "Optional[Power]":
        """Power of the drive, (points,) each; None where not computed."""
        from .machine_loads import Power, made

        return made(Power, self._document.get("power"), floats)

    @cached_property
    def flywheel(self) -> "Optional[Flywheel]":
        """energy_fluctuation, speed_fluctuation, (points,); None where not computed."""
        from .machine_loads import Flywheel, made

        return made(Flywheel, self._document.get("flywheel"), floats)

    @property
    def problems(self) -> list[dict[str, Any]]:
        """Points without an answer: `index`, `x`, `reason`."""
        return deepcopy(self._document.get("problems", []))

    @property
    def refined(self) -> dict[str, Any]:
        """Points between those asked for, at peaks and boundaries: `x` and `rods`, as in the document; empty: none."""
        return deepcopy(self._document.get("refined", {}))

    @property
    def fold_details(self) -> list[dict[str, Any]]:
        """Folds of the motion without linearisation: `rpm` or `x`, `error`, `branch`."""
        return deepcopy(self._document.get("fold_details", []))

    @property
    def jumps(self) -> list[dict[str, Any]]:
        """Where a stable motion without linearisation ends when the number is moved slowly, and what it jumps to."""
        return deepcopy(self._document.get("jumps", []))

    @property
    def system(self) -> Optional[dict[str, Any]]:
        """Of all rods together, without linearisation, by points as in the document; else None."""
        return deepcopy(self._document.get("system"))

    @property
    def linear_verdict(self) -> Optional[list[Any]]:
        """Beside a motion without linearisation, the linear theory's verdict at each point; else None."""
        return deepcopy(self._document.get("linear_verdict"))

    @property
    def rods(self) -> dict[str, SweepRod]:
        """Elastic links by name."""
        return dict(self._rods)

    def to_frame(self) -> "pandas.DataFrame":
        """The points as a pandas DataFrame: index is the axis, columns are (rod, quantity)."""
        from . import frames

        return frames.of_sweep(self)

    def to_xarray(self) -> "xarray.Dataset":
        """The points as an xarray Dataset over (x, rod, mode)."""
        from . import frames

        return frames.sweep_dataset(self)

    def plot(self, kind: str = "campbell", rod: Optional[str] = None, ax: Optional["Axes"] = None) -> "Axes":
        """Draws one rod (default: the first): "campbell", "growth", "peaks", "deflection" or "branches"."""
        from . import plots

        return plots.sweep(self, kind, rod, ax)

    def report(self, file: Any, *, pictures: bool = True, threads: Any = 1) -> None:
        """Writes one self-contained HTML page that moves."""
        from .reports import sweep

        sweep(self, file, pictures=pictures, threads=threads)

    def __getitem__(self, name: str) -> SweepRod:
        if name in self._rods:
            return self._rods[name]
        raise KeyError(f"{name}: no elastic link here; there are {', '.join(self._rods) or 'none'}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._rods)

    def __contains__(self, name: object) -> bool:
        return name in self._rods

    def __len__(self) -> int:
        return len(self._document["x"]["values"])

    def __repr__(self) -> str:
        return f"<hb.Sweep of {self._scene.name} along {self.path}: {len(self)} points, {', '.join(self._rods)}>"
