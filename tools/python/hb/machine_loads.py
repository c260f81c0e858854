"""What a machine's designer reads: stress and safety, bearings, frame, drive, sliders. Numbers are those of the command's
document, in the scene's units (forces mass length/time^2, stresses mass/(length time^2), angles in its unit).

At one speed each attribute is a number; along a sweep it is a read-only array, (points,), NaN where a point has none, and
what only a single speed gives is None.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, Callable, Mapping, Optional, TypeVar

_Kind = TypeVar("_Kind")


@dataclass(frozen=True)
class Range:
    """Smallest and largest over the turn."""

    min: Any
    max: Any
    error: Any = None
    """Of both; None: see where the range belongs to."""


@dataclass(frozen=True)
class Peak:
    """The largest value over rod and turn, and where."""

    max_abs: Any
    x: Any
    """From joint 0, in the unit of length."""
    crank_angle: Any
    error: Any = None
    """Of max_abs, from the modes left out; None: see the rod's modes_error."""


@dataclass(frozen=True)
class AxialForce:
    """The axial force in a rod over rod and turn."""

    tension: Any
    """Largest pull, >= 0."""
    compression: Any
    """Largest push, >= 0."""
    buckling_load: Any
    """pi^2 EJ/l^2, of the rod pinned at both ends."""
    buckling_share: Any
    """compression/buckling_load."""
    error: Any = None
    """Of tension and compression."""
    buckling_share_error: Any = None


@dataclass(frozen=True)
class Stress:
    """Stress over rod and turn. Sides are 1 (the fibre to the right of the way from joint 0 to joint 1) and -1 (left)."""

    axial: Any = None
    """Largest |N|/F."""
    axial_error: Any = None
    bending: Any = None
    """Largest |M| e/J."""
    bending_error: Any = None
    """An estimate, from the modes left out; None where they were not looked at."""
    height_known: Optional[bool] = None
    """Whether the scene gives a `section`; else e is that of a rectangle, and what follows is None."""
    max_abs: Any = None
    """Largest |N/F +- M e/J| of one place, time and fibre."""
    x: Any = None
    """Its place from joint 0."""
    crank_angle: Any = None
    """Its crank angle."""
    side: Optional[int] = None
    mean: Any = None
    """Mean of the widest cycle."""
    amplitude: Any = None
    """Its amplitude."""
    amplitude_x: Any = None
    amplitude_side: Optional[int] = None
    error: Any = None
    """Of max_abs, mean and amplitude, an estimate."""
    yield_safety: Any = None
    """S_y/max_abs, with the key `yield`. None (sweeps: NaN, or infinite stresses' absence) where there is none."""
    yield_safety_error: Any = None
    fatigue_safety: Any = None
    """n of 1/n = amplitude/S_e + max(mean, 0)/S at the place where it is smallest."""
    fatigue_safety_error: Any = None
    fatigue_line: Optional[str] = None
    """"Goodman" (S = tensile) or "Soderberg" (S = yield)."""
    fatigue_mean: Any = None
    fatigue_amplitude: Any = None
    fatigue_x: Any = None
    fatigue_side: Optional[int] = None


@dataclass(frozen=True)
class NearestResonance:
    """The speed nearest to this one at which order times Omega is the lowest natural frequency of the mean system."""

    order: int
    rpm: float
    omega: float
    frequency: float
    """The natural frequency there, rad per unit time."""
    in_response: bool
    """Whether the response has a harmonic of this order, or a higher one, above its error bound."""


@dataclass(frozen=True)
class Bearing:
    """Length of a joint's force."""

    max: Any
    crank_angle: Any = None
    mean: Any = None
    rms: Any = None
    error: Any = None
    """Of these lengths, from joints_error + joints_modes_error."""
    max_rigid: Any = None
    crank_angle_rigid: Any = None


@dataclass(frozen=True)
class Frame:
    """Shaking force (global axes) and shaking moment (about the crank's pivot) on the frame."""

    max: Any
    """Largest resultant force."""
    moment: Range
    x: Optional[Range] = None
    y: Optional[Range] = None
    x_rigid: Optional[Range] = None
    y_rigid: Optional[Range] = None
    moment_rigid: Optional[Range] = None
    crank_angle: Any = None
    max_rigid: Any = None
    force_error: Any = None
    """Bound on the error of a force."""
    moment_error: Any = None


@dataclass(frozen=True)
class Power:
    """Power of the drive, torque times speed."""

    min: Any
    max: Any
    mean: Any
    rms: Any
    error: Any = None
    """Of each of these."""
    mean_theory_error: Any = None
    """What the first nonlinear correction changes of the mean; None: no value, not judged, or without linearisation."""


@dataclass(frozen=True)
class Flywheel:
    """What a flywheel takes up and gives back in a turn."""

    energy_fluctuation: Any
    """Energy."""
    speed_fluctuation: Any
    """(largest - smallest)/mean speed with the crank's inertia, a first estimate; None (NaN) without inertia."""
    inertia: Any = None
    """The crank's, about its pivot."""
    energy_fluctuation_error: Any = None
    speed_fluctuation_error: Any = None


@dataclass(frozen=True)
class SliderMotion:
    """Position of a slider from its guide's point along its direction, and its derivatives in time."""

    position: Range
    velocity: Range
    acceleration: Range


@dataclass(frozen=True)
class Torque:
    """Driving torque over the turn."""

    min: Any
    max: Any
    mean: Any = None
    rms: Any = None
    error: Any = None
    """Of each of these."""
    mean_theory_error: Any = None
    """What the first nonlinear correction changes of the mean; None: no value, not judged, or without linearisation."""
    rigid: Optional["Torque"] = None
    """The same of the rigid mechanism."""



def made(kind: type[_Kind], entry: Optional[Mapping[str, Any]], number: Callable[[Any], Any] = lambda v: v) -> Optional[_Kind]:
    """The entry of a document as such an object; None where there is no entry."""
    if entry is None:
        return None
    values: dict[str, Any] = {}
    for field in fields(kind):  # type: ignore[arg-type]
        value = entry.get(field.name)
        if isinstance(value, Mapping):
            values[field.name] = made(Torque if field.name == "rigid" else Range, value, number)
        elif value is not None:
            values[field.name] = number(value)
        elif field.name in entry:
            values[field.name] = None
    return kind(**values)


def made_by_name(
    kind: type[_Kind], entries: Optional[Mapping[str, Any]], number: Callable[[Any], Any] = lambda v: v
) -> dict[str, _Kind]:
    """Objects by the names of a document's entry; empty where there is none."""
    found = {name: made(kind, entry, number) for name, entry in (entries or {}).items()}
    return {name: one for name, one in found.items() if one is not None}
