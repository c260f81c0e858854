"""The damping of one mode from a measurement of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _core

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class DampingFit:
    """One mode fitted by least squares; `ratio` is what `damping_ratio` of an elastic link takes."""

    frequency: float
    """Of the undamped mode, rad per unit of the measured time."""
    frequency_error: float
    """Standard error, as if each value had an independent error of the same size."""
    ratio: float
    """Damping ratio: decay rate over frequency."""
    ratio_error: float
    residual: float
    """What is left over, rms, of the measurement."""
    fitted: "NDArray[Any]"
    """The curve at the measured places."""


def fit_decay(t: "ArrayLike", x: "ArrayLike") -> DampingFit:
    """Of a free vibration x at increasing times t, (n,) both, n >= 8: e^(-ratio frequency t) times a cosine, and a constant.
    RequestError for values that do not change, less than one period, or fewer than three values in a period."""
    return DampingFit(*_core.fit_decay(t, x))


def fit_peak(omega: "ArrayLike", amplitude: "ArrayLike") -> DampingFit:
    """Of amplitudes at increasing frequencies (rad per unit time), (n,) both, n >= 5, with a peak between both ends: the
    displacement of one mode under a harmonic force of constant size. RequestError where there is no peak."""
    return DampingFit(*_core.fit_peak(omega, amplitude))
