"""Harmonic balance beside time integration."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Optional

from . import _core
from .result import Result


class RodCheck:
    """One elastic link: differences beside what the error bars of both paths allow. At several speeds each is a list."""

    def __init__(self, name: str, entry: dict[str, Any]) -> None:
        self.name = name
        self._entry = entry

    @property
    def agrees(self) -> Any:
        """Whether everything that could be compared agrees; None where nothing could."""
        return self._entry["agrees"]

    @property
    def q_difference(self) -> Any:
        """Largest difference of q over turn and modes, relative to the largest |q|."""
        return self._entry["q_difference"]

    @property
    def q_allowed(self) -> Any:
        """What the error bars allow for q_difference."""
        return self._entry["q_allowed"]

    @property
    def exponent_difference(self) -> Any:
        """Largest distance of the exponents that both paths resolve, 1/time."""
        return self._entry.get("exponent_difference")

    @property
    def exponent_allowed(self) -> Any:
        """What the error bars allow for exponent_difference."""
        return self._entry.get("exponent_allowed")

    @property
    def q1_difference(self) -> Any:
        """Largest difference of dq/dt, relative to the largest."""
        return self._entry.get("q1_difference")

    @property
    def q1_allowed(self) -> Any:
        """What the error bars allow for q1_difference."""
        return self._entry.get("q1_allowed")

    @property
    def deflection_difference(self) -> Any:
        """Largest difference of the deflection over rod and turn, relative to the largest; None of a [hill] system."""
        return self._entry.get("deflection_difference")

    @property
    def deflection_allowed(self) -> Any:
        """What the error bars allow for deflection_difference."""
        return self._entry.get("deflection_allowed")

    @property
    def marching_difference(self) -> Any:
        """With march=True: difference of q after the transient has died out; else None."""
        return self._entry.get("marching_difference")

    @property
    def marching_allowed(self) -> Any:
        """What the error bars allow for marching_difference."""
        return self._entry.get("marching_allowed")

    @property
    def harmonic_balance(self) -> Any:
        """What harmonic balance took and gave, with the keys of the document."""
        return self._entry.get("harmonic_balance")

    @property
    def shooting(self) -> Any:
        """What shooting took and gave, with the keys of the document."""
        return self._entry.get("shooting")

    @property
    def marching(self) -> Any:
        """What marching took and gave, with the keys of the document; None where it was not asked for."""
        return self._entry.get("marching")

    @property
    def theory_error(self) -> Any:
        """By how much the linear theory itself is off, relative; None: beyond it, or not judged."""
        return self._entry.get("theory_error")

    @property
    def verdict(self) -> Any:
        """At several speeds, a list of the verdicts of shooting; else None: see harmonic_balance and shooting."""
        return self._entry.get("verdict")

    @property
    def not_compared(self) -> Optional[str]:
        """Why there is no comparison; None where there is one."""
        return self._entry.get("not_compared")

    def to_dict(self) -> dict[str, Any]:
        """Its entry in the document."""
        return dict(self._entry)

    def __repr__(self) -> str:
        return f"<hb.RodCheck {self.name}: agrees {self.agrees}>"


class Check(Result):
    """Two paths that share nothing but the kinematics: `c["AB"]` is one elastic link (hb.RodCheck)."""

    def __init__(self, scene: Any, arguments: dict[str, Any], core: _core.Check) -> None:
        super().__init__(scene, arguments, core)
        self._missed: list[str] = core.shortfalls

    def _computed(self) -> _core.Check:
        return _core.check(self._scene._core, self._arguments, None)

    @property
    def agrees(self) -> bool:
        """Whether both paths agree in everything that could be compared."""
        return bool(self._document["agrees"])

    @property
    def verdict(self) -> Any:
        """Of the mechanism, by harmonic balance: "stable", "bounded", "unstable" or "undecided"; at several speeds a list.
        None where stability was not asked for."""
        return self._document.get("verdict")

    @property
    def rpm(self) -> Any:
        """Speed, turns per minute; at several speeds a list."""
        return self._document["rpm"]

    @property
    def omega(self) -> Any:
        """Speed, rad per unit time; at several speeds a list."""
        return self._document["omega"]

    @property
    def joints(self) -> Any:
        """`difference`, `allowed`, `agrees` of joint forces, relative to the largest; None where not compared."""
        return self._document.get("joints")

    @property
    def torque(self) -> Any:
        """The same of the driving torque."""
        return self._document.get("torque")

    @property
    def joints_theory_error(self) -> Any:
        """What both paths leave out of the joint forces, of the largest; at several speeds a list. None: not judged."""
        return self._document.get("joints_theory_error")

    @property
    def torque_theory_error(self) -> Any:
        """The same of the driving torque."""
        return self._document.get("torque_theory_error")

    @property
    def growth_theory_error(self) -> Any:
        """What the nonlinear correction changes of the mechanism's growth rate, 1/time."""
        return self._document.get("growth_theory_error")

    @property
    def status(self) -> str:
        """Whether everything reached its tolerance and was compared: "reached" or "tolerance not reached"."""
        return str(self._document["status"])

    @property
    def shortfalls(self) -> list[str]:
        """What missed its tolerance, or could not be compared."""
        return list(self._missed)

    @property
    def rods(self) -> dict[str, RodCheck]:
        """Elastic links by name."""
        return {name: RodCheck(name, entry) for name, entry in self._document["rods"].items()}

    @property
    def seconds(self) -> dict[str, float]:
        """Time taken by either path."""
        return dict(self._document["seconds"])

    def to_frame(self) -> Any:
        """The differences as a pandas DataFrame, a row for each rod (and speed)."""
        from . import frames

        return frames.of_check(self)

    def plot(self, ax: Any = None) -> Any:
        """Draws differences beside what is allowed."""
        from . import plots

        return plots.check(self, ax)

    def report(self, file: Any) -> None:
        """Writes one self-contained HTML page: the table and, with matplotlib, the picture."""
        from .reports import in_words

        in_words(self, "check", file)

    def __getitem__(self, name: str) -> RodCheck:
        rods = self._document["rods"]
        if name in rods:
            return RodCheck(name, rods[name])
        raise KeyError(f"{name}: no elastic link here; there are {', '.join(rods)}")

    def __iter__(self) -> Iterator[str]:
        return iter(self._document["rods"])

    def __repr__(self) -> str:
        return f"<hb.Check of {self._scene.name}: {'agrees' if self.agrees else 'DISAGREES'}>"
