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

    from .machine_loads import AxialForce, Bearing, Flywheel, Frame, NearestResonance, Peak, Power, SliderMotion, Stress
    from .scene import Scene


def _document(answer: _core.Answer) -> dict[str, Any]:
    if not hasattr(answer, "document"):
        answer.document = json.loads(answer.json())
    return answer.document


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
    def title(self) -> str:
        """The scene's title."""
        return str(self._doc["title"])

    @property
    def status(self) -> str:
        """"reached", or "tolerance not reached"."""
        return str(self._doc["status"])

    @property
    def notes(self) -> list[str]:
        """`shortfalls`, and what is known less well than usual though no tolerance was asked for it."""
        return list(self._doc.get("notes", []))

    @property
    def tolerance(self) -> float:
        """The relative error asked for."""
        return float(self._doc["tolerance"])

    @property
    def units(self) -> dict[str, Any]:
        """The scene's units, and what its units of force and torque are in N and N m."""
        return dict(self._doc["units"])

    @property
    def bearings(self) -> "dict[str, Bearing]":
        """Length of each joint's force by the joint's name: its largest value, where, mean and rms; empty where joint
        forces were not computed."""
        from .machine_loads import Bearing, made_by_name

        return made_by_name(Bearing, self._doc.get("bearings"))

    @property
    def frame(self) -> "Optional[Frame]":
        """Shaking force and moment; None where not computed."""
        from .machine_loads import Frame, made

        return made(Frame, self._doc.get("frame"))

    @property
    def power(self) -> "Optional[Power]":
        """Power of the drive; None where not computed."""
        from .machine_loads import Power, made

        return made(Power, self._doc.get("power"))

    @property
    def flywheel(self) -> "Optional[Flywheel]":
        """What a flywheel takes up, and the fluctuation of the speed; None where not computed."""
        from .machine_loads import Flywheel, made

        return made(Flywheel, self._doc.get("flywheel"))

    @property
    def sliders(self) -> "dict[str, SliderMotion]":
        """Motion of each slider by name; empty where there is none or it was not computed."""
        from .machine_loads import SliderMotion, made_by_name

        return made_by_name(SliderMotion, self._doc.get("sliders"))

    @property
    def joints_error(self) -> Optional[float]:
        """Estimated error of joint forces for the modes kept, relative to the largest; None: not computed."""
        return self._doc.get("joints_error")

    @property
    def torque_error(self) -> Optional[float]:
        """The same of the torque."""
        return self._doc.get("torque_error")

    @property
    def joints_modes_error(self) -> Optional[float]:
        """Estimated error of joint forces from the modes left out, relative to the largest."""
        return self._doc.get("joints_modes_error")

    @property
    def torque_modes_error(self) -> Optional[float]:
        """The same of the torque."""
        return self._doc.get("torque_modes_error")

    @property
    def joints_theory_error(self) -> Optional[float]:
        """What the first nonlinear correction changes of joint forces, relative; None: no value, or not judged."""
        return self._doc.get("joints_theory_error")

    @property
    def torque_theory_error(self) -> Optional[float]:
        """The same of the torque."""
        return self._doc.get("torque_theory_error")

    @property
    def growth_theory_error(self) -> Optional[float]:
        """What the first nonlinear correction changes of the mechanism's growth rate, per unit time; None: no value, or
        not judged."""
        return self._doc.get("growth_theory_error")

    @property
    def bands(self) -> list[dict[str, Any]]:
        """With band=...: of each what hb steady --json has, `parameter`, `from`, `to`, verdicts at both ends and
        `quantities` (in mm, N, N m, MPa, Hz) there and as given, with errors and slopes; else empty."""
        return list(self._doc.get("bands", []))

    @property
    def theory(self) -> str:
        """"linear" or "nonlinear"."""
        return str(self._doc.get("theory", "linear"))

    @property
    def period(self) -> int:
        """Number of turns after which the motion repeats."""
        return int(self._doc.get("period", 1))

    @property
    def found(self) -> bool:
        """Whether there is a motion; False only where the motion without linearisation was not found."""
        return bool(self._doc.get("found", True))

    @property
    def other_motions(self) -> list[dict[str, Any]]:
        """Other motions without linearisation met at this speed: `rods`, `verdict`."""
        return list(self._doc.get("other_motions", []))

    @property
    def last_motion(self) -> Optional[dict[str, Any]]:
        """No motion found: the last one on the way, `rpm`, `omega`, `rods`; else None."""
        return self._doc.get("last_motion")

    @property
    def followed_from_rpm(self) -> Optional[float]:
        """Where the branch began; None where the linear answer is near at all lower speeds, or of the linear theory."""
        return self._doc.get("followed_from_rpm")

    @property
    def folds_passed(self) -> int:
        """Folds on the way along the branch."""
        return int(self._doc.get("folds_passed", 0))

    @property
    def motion_tolerance(self) -> Optional[float]:
        """What a motion without linearisation was solved to, relative; else None."""
        return self._doc.get("motion_tolerance")

    @property
    def modes_tolerance(self) -> Optional[float]:
        """With modes="auto", what modes_error was brought below; else None."""
        return self._doc.get("modes_tolerance")

    @property
    def warnings(self) -> list[str]:
        """What is odd about the scene, and where the answer is beyond the linear theory."""
        return list(self._doc.get("warnings", []))

    @property
    def _doc(self) -> dict[str, Any]:
        return _document(self._answer)

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


def _entry(rod: Rod) -> dict[str, Any]:
    entry: dict[str, Any] = _document(rod._owner)["rods"][rod.name]
    return entry


def _peak(rod: Rod, key: str) -> "Optional[Peak]":
    from .machine_loads import Peak, made

    return made(Peak, _entry(rod).get(key))


def _deflection_peak(self: Rod) -> "Optional[Peak]":
    """Largest |w| over rod and turn, and where; relative error: modes_error. None: not computed."""
    return _peak(self, "deflection")


def _bending_moment_peak(self: Rod) -> "Optional[Peak]":
    """Largest bending moment over rod and turn, and where; None: not computed."""
    return _peak(self, "bending_moment")


def _static_deflection(self: Rod) -> "Optional[Peak]":
    """Largest deflection of the mechanism at rest, with its error; None: not computed, or the rod would buckle."""
    return _peak(self, "static_deflection")


def _axial_force(self: Rod) -> "Optional[AxialForce]":
    """Largest pull and push, and the share of the buckling load; None: not computed."""
    from .machine_loads import AxialForce, made

    return made(AxialForce, _entry(self).get("axial_force"))


def _stress(self: Rod) -> "Optional[Stress]":
    """Largest stress, widest cycle, safeties against yielding and fatigue, with errors; None: not computed."""
    from .machine_loads import Stress, made

    return made(Stress, _entry(self).get("stress"))


def _nearest_resonance(self: Rod) -> "Optional[NearestResonance]":
    """The nearest speed at which a natural frequency is met; None: not computed, or none."""
    from .machine_loads import NearestResonance, made

    return made(NearestResonance, _entry(self).get("nearest_resonance"))


def _frequencies(self: Rod) -> Any:
    """Frequency of each exponent, unfolded, rad per unit time, read-only; None: not computed."""
    from .result import floats

    values = _entry(self).get("frequencies")
    return None if values is None else floats(values)


def _list_of(key: str, doc: str) -> property:
    def get(self: Rod) -> Any:
        from .result import floats

        values = _entry(self).get(key)
        return None if values is None else floats(values)

    get.__doc__ = doc
    return property(get)


def _multipliers(self: Rod) -> Any:
    """Floquet multiplier of each exponent, complex, read-only; None: not computed."""
    import numpy

    values = _entry(self).get("multipliers")
    if values is None:
        return None
    array = numpy.array([complex(*pair) for pair in values])
    array.flags.writeable = False
    return array


def _of_entry(key: str, doc: str) -> property:
    def get(self: Rod) -> Any:
        return _entry(self).get(key)

    get.__doc__ = doc
    return property(get)


for _key, _attribute in {
    "deflection_peak": property(_deflection_peak),
    "bending_moment_peak": property(_bending_moment_peak),
    "static_deflection": property(_static_deflection),
    "axial_force": property(_axial_force),
    "stress": property(_stress),
    "nearest_resonance": property(_nearest_resonance),
    "frequencies": property(_frequencies),
    "multipliers": property(_multipliers),
    "frequencies_hz": _list_of("frequencies_hz", "Frequency of each exponent in Hz; None: not computed."),
    "frequencies_hz_errors": _list_of("frequencies_hz_errors", "Their errors, Hz."),
    "damping_ratios": _list_of("damping_ratios", "-Re/|exponent| of each exponent at its frequency; None: not computed."),
    "damping_ratio_errors": _list_of("damping_ratio_errors", "Their errors."),
    "strain": _of_entry("strain", "Largest strain, axial and bending added; None: not computed."),
    "amplification": _of_entry("amplification", "Largest |q| against that of the same load applied slowly; None: no value."),
    "resonance_distance": _of_entry("resonance_distance", "Smallest singular value of the scaled balance: 0 at a resonance."),
    "status": _of_entry("status", "Of the periodic solution, in words; None: not computed."),
    "steady_method": _of_entry("steady_method", "How the periodic solution was found."),
    "residual": _of_entry("residual", "Relative residual of the periodic solution."),
    "error_bound_proved": _of_entry("error_bound_proved", "Whether error_bound is proved, not estimated."),
    "more_modes_needed": _of_entry("more_modes_needed", "Whether modes_error is above 0.01; None: not asked."),
    "theory": _of_entry("theory", '"within", "beyond" or "not judged"; None of a [hill] system.'),
    "deflection_theory_error": _of_entry(
        "deflection_theory_error", "theory_error of the deflection; None: beyond, or not judged."
    ),
    "theory_axial_share": _of_entry(
        "theory_axial_share", "What axial elasticity would change of theory_error, a share of it, a rough estimate; or None."
    ),
    "exponents_unresolved": _of_entry("exponents_unresolved", "How many exponents were looked for and not resolved."),
    "exponents_uncertain": _of_entry(
        "exponents_uncertain", "Exponents with bars too wide, as in the document: exponent and error of each; None: not computed."
    ),
    "growth_modes": _of_entry("growth_modes", "Number of Ritz terms of the exponents; None: not computed."),
    "growth_modes_error": _of_entry(
        "growth_modes_error", "Estimated relative error of the growth rate from the modes left out; None: not asked."
    ),
}.items():
    setattr(Rod, _key, _attribute)

for _name, _function in {
    "to_dict": _rod_to_dict,
    "to_frame": _rod_to_frame,
    "plot": _rod_plot,
    "__reduce__": _rod_reduce,
}.items():
    _function.__name__ = _name
    _function.__qualname__ = f"Rod.{_name}"
    setattr(Rod, _name, _function)
