"""A design that was searched for."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Optional

from . import _core
from .result import Result

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

    from .scene import Scene as _Scene


class Tune(Result):
    """Goal, conditions and numbers before and after; `t.scene` is the tuned scene, `t.values` its numbers by path."""

    def __init__(self, scene: "_Scene", arguments: dict[str, Any], core: _core.Tune) -> None:
        super().__init__(scene, arguments, core)
        self._shortfall: str = core.shortfall
        self._remarks: list[str] = core.remarks
        self._tuned: str = core.scene_text(scene._core.name, scene._core.folder)

    def _computed(self) -> _core.Tune:
        return _core.tune(self._scene._core, self._arguments, None)

    @property
    def before(self) -> "_Scene":
        """The scene that the search began from."""
        return self._scene

    @cached_property
    def scene(self) -> "_Scene":
        """The tuned scene; where no design meets all conditions, the nearest."""
        from .scene import Scene

        return Scene(self._tuned, name=self._scene._core.name, folder=self._scene._core.folder)

    @property
    def values(self) -> dict[str, float]:
        """Numbers found, by path; those that are tied to others too."""
        found: dict[str, float] = {}
        for entry in self._document["variables"]:
            found[entry["path"]] = entry["after"]
            found.update(entry.get("tied", {}))
        return found

    @property
    def goal(self) -> dict[str, Any]:
        """The goal before and after, its error and unit."""
        return dict(self._document["goal"])

    @property
    def conditions(self) -> list[dict[str, Any]]:
        """Each condition with its value, bound and whether it is met."""
        return [dict(entry) for entry in self._document["conditions"]]

    @property
    def status(self) -> str:
        """How the search ended."""
        return str(self._document["status"])

    @property
    def verified(self) -> bool:
        """Whether goal and conditions hold on four times the speeds, with the errors of their values."""
        return bool(self._document["verified"])

    @property
    def shortfalls(self) -> list[str]:
        """Empty, or what was not reached."""
        return [self._shortfall] if self._shortfall else []

    @property
    def remarks(self) -> list[str]:
        """Where the search starts, where that is not the scene's own design."""
        return list(self._remarks)

    def to_frame(self) -> "pandas.DataFrame":
        """Every design tried: variables, goal, excess of the conditions."""
        from . import frames

        return frames.of_table(self._core.table())

    def plot(self, ax: Optional["Axes"] = None) -> "Axes":
        """Draws the goal over the designs tried."""
        from . import plots

        return plots.tune(self, ax)

    def report(self, file: Any) -> None:
        """Writes one self-contained HTML page: the design after along its speeds, beside the design before."""
        from .reports import tune

        tune(self, file)

    def __repr__(self) -> str:
        numbers = ", ".join(f"{path} = {value:.6g}" for path, value in self.values.items())
        return f"<hb.Tune of {self._scene.name}: {self.status}, {numbers}>"
