"""Error against run time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Optional

from . import _core
from .result import Result

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes


class RodBench:
    """One elastic link, or without linearisation all of them together ("system")."""

    def __init__(self, name: str, entry: dict[str, Any]) -> None:
        self.name = name
        self._entry = entry

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One for each case: method, asked (tolerance; None: none), harmonics_or_steps, error (max |q - reference| / max
        |reference|; None: not finite), seconds (shortest run), seconds_median."""
        return [dict(row) for row in self._entry["rows"]]

    @property
    def reference_error(self) -> float:
        """Error of the reference itself."""
        return float(self._entry["reference_error"])

    @property
    def verdict(self) -> str:
        """"stable", "bounded", "unstable" or "undecided", of the reference."""
        return str(self._entry["verdict"])

    @property
    def theory_error(self) -> Optional[float]:
        """By how much the linear theory itself is off, relative; None: beyond it, of a [hill] system, or without
        linearisation."""
        return self._entry.get("theory_error")

    @property
    def left_out(self) -> list[str]:
        """What was left out, and why."""
        return list(self._entry["left_out"])

    @property
    def ratios(self) -> list[str]:
        """Harmonic balance and the fastest integration at equal accuracy, in words."""
        return list(self._entry["ratios"])

    def to_dict(self) -> dict[str, Any]:
        """Its entry in the document."""
        return dict(self._entry)

    def __repr__(self) -> str:
        return f"<hb.RodBench {self.name}: {len(self._entry['rows'])} cases>"


class Bench(Result):
    """Error and time of every method: `b["AB"]` is one elastic link (hb.RodBench). Times are those of this run."""

    def _computed(self) -> _core.Bench:
        return _core.bench(self._scene._core, self._arguments, None)

    def __init__(self, scene: Any, arguments: dict[str, Any], core: _core.Bench) -> None:
        super().__init__(scene, arguments, core)
        self._missed: list[str] = core.shortfalls
        self._words: str = core.words()

    @property
    def rods(self) -> dict[str, RodBench]:
        """Elastic links by name."""
        return {name: RodBench(name, entry) for name, entry in self._document["rods"].items()}

    @property
    def shortfalls(self) -> list[str]:
        """Why there is no reference, where there is none."""
        return list(self._missed)

    def to_frame(self) -> "pandas.DataFrame":
        """A pandas DataFrame with a row for each case."""
        from . import frames

        return frames.of_bench(self)

    def plot(self, rod: Optional[str] = None, ax: Optional["Axes"] = None) -> "Axes":
        """Draws error over time of one rod (default: the first), a line for each method."""
        from . import plots

        return plots.bench(self, rod, ax)

    def report(self, file: Any) -> None:
        """Writes one self-contained HTML page: the table and, with matplotlib, the picture."""
        from .reports import in_words

        in_words(self, "bench", file)

    def __str__(self) -> str:
        return self._words

    def __getitem__(self, name: str) -> RodBench:
        rods = self._document["rods"]
        if name in rods:
            return RodBench(name, rods[name])
        raise KeyError(f"{name}: no elastic link here; there are {', '.join(rods)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._document["rods"])

    def __repr__(self) -> str:
        return f"<hb.Bench of {self._scene.name}: {', '.join(self._document['rods'])}>"
