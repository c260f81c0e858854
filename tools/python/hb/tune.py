"""A design that was searched for."""

from __future__ import annotations

from copy import deepcopy
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
    def verdict(self) -> Optional[str]:
        """Of the mechanism with the design found, over all speeds; None where it has none."""
        return self._document.get("verdict")

    @property
    def verdict_before(self) -> Optional[str]:
        """Of the mechanism with the design before, over all speeds; None where it has none."""
        return self._document.get("verdict_before")

    @property
    def over(self) -> Any:
        """The range of speeds of the design found, as in the document."""
        return deepcopy(self._document.get("over"))

    @property
    def over_before(self) -> Any:
        """The range of speeds of the design before."""
        return deepcopy(self._document.get("over_before"))

    @property
    def modes(self) -> Any:
        """Ritz terms of the elastic links."""
        return deepcopy(self._document.get("modes"))

    @property
    def variables(self) -> list[dict[str, Any]]:
        """Each number varied: path, before, after, bounds, unit, and those tied to it."""
        return deepcopy(self._document["variables"])

    @property
    def before_differs(self) -> Any:
        """Whether the design before is not the scene's own, and why."""
        return deepcopy(self._document.get("before_differs"))

    @property
    def metrics(self) -> Any:
        """Quantities of the goal and the conditions before and after, with errors, theory errors (in their unit) and places."""
        return deepcopy(self._document.get("metrics"))

    @property
    def without_effect(self) -> Any:
        """Numbers varied that change nothing."""
        return deepcopy(self._document.get("without_effect"))

    @property
    def worst_at_once(self) -> Any:
        """Rods that are worst at once: where the goal has a kink."""
        return deepcopy(self._document.get("worst_at_once"))

    @property
    def damping_sensitivity(self) -> Any:
        """How the goal depends on damping at the design found."""
        return deepcopy(self._document.get("damping_sensitivity"))

    @property
    def damping_sensitivity_of_best(self) -> Any:
        """The same of the best design of those tried."""
        return deepcopy(self._document.get("damping_sensitivity_of_best"))

    @property
    def slope_left_over(self) -> Any:
        """What the slopes of goal and conditions do not balance, relative; None: not known."""
        return self._document.get("slope_left_over")

    @property
    def analyses(self) -> Any:
        """Designs analysed."""
        return self._document.get("analyses")

    @property
    def analyses_for_slopes(self) -> Any:
        """How many of these are neighbours of other designs, for slopes by differences."""
        return self._document.get("analyses_for_slopes")

    @property
    def analyses_after(self) -> Any:
        """Analyses beside the search, for slopes at the design found."""
        return self._document.get("analyses_after")

    @property
    def confirmations(self) -> Any:
        """Analyses on four times the speeds."""
        return self._document.get("confirmations")

    @property
    def gradients(self) -> Any:
        """Designs whose slopes were computed."""
        return self._document.get("gradients")

    @property
    def not_closing(self) -> Any:
        """Designs whose linkage does not close."""
        return self._document.get("not_closing")

    @property
    def refused(self) -> Any:
        """Designs that cannot be."""
        return deepcopy(self._document.get("refused"))

    @property
    def without_response(self) -> Any:
        """Designs without a periodic answer at some speed."""
        return self._document.get("without_response")

    @property
    def evidence(self) -> Any:
        """One sentence: what was done."""
        return self._document.get("evidence")

    @property
    def shortfall(self) -> Optional[str]:
        """What was not reached, in one sentence; None: nothing."""
        return self._document.get("shortfall")

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
