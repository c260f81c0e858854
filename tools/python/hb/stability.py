"""What Python adds to hb.Stability: its numbers as a document, table and picture."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Optional

from ._core import Stability

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


def _number(value: float) -> Optional[float]:
    return float(value) if math.isfinite(value) else None


def _to_dict(self: Stability) -> dict[str, Any]:
    """The same keys as under "rods" of `hb steady --json`."""
    return {
        "exponents": [[float(value.real), float(value.imag)] for value in self.exponents],
        "exponent_errors": [float(error) for error in self.exponent_errors],
        "growth_rate": _number(self.growth_rate),
        "exponent_error": _number(self.growth_error),
        "growth_interval": [_number(end) for end in self.growth_interval],
        "verdict": self.verdict,
        "stability_method": self.method,
        "stability_converged": self.converged,
        "frequencies_hz": [_number(value) for value in self.frequencies_hz],
        "frequencies_hz_errors": [_number(value) for value in self.frequencies_hz_errors],
        "damping_ratios": [_number(value) for value in self.damping_ratios],
        "damping_ratio_errors": [_number(value) for value in self.damping_ratio_errors],
    }


def _to_frame(self: Stability) -> "pandas.DataFrame":
    """A pandas DataFrame with a row for each exponent."""
    from .frames import of_stability

    return of_stability(self)


def _plot(self: Stability, ax: Optional["Axes"] = None) -> "Axes":
    """Draws the exponents with their errors in the complex plane."""
    from .plots import stability

    return stability(self, ax)


for _name, _function in {"to_dict": _to_dict, "to_frame": _to_frame, "plot": _plot}.items():
    _function.__name__ = _name
    _function.__qualname__ = f"Stability.{_name}"
    setattr(Stability, _name, _function)
