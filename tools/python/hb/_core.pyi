"""The compiled half of the package hb: scenes, analyses and their results."""

from typing import Any, Callable, Optional, Union

import pandas
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

version: str

_Table = tuple[list[str], NDArray[Any]]
_Progress = Optional[Callable[[str, int, int], object]]

class Scene:
    def __init__(self, text: str, name: str, folder: str) -> None: ...
    @staticmethod
    def load(file: str) -> Scene: ...
    def changed(self, values: list[tuple[str, str]], /) -> Scene: ...
    @property
    def text(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def folder(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def units(self) -> dict[str, str]: ...
    @property
    def rods(self) -> list[str]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def is_linkage(self) -> bool: ...
    def paths(self) -> list[str]: ...
    def value(self, path: str, /) -> float: ...
    def table(self) -> str: ...
    def json(self) -> str: ...
    def mechanism(self) -> Optional[_Table]: ...
    def drawing(self) -> str: ...

class Stability:
    """Floquet exponents of a periodic motion, the growth rate and what is known of its sign."""

    @property
    def exponents(self) -> NDArray[Any]:
        """Exponents, 1/time: real part descending, imaginary part folded to (-Omega/2, Omega/2]. Read-only."""
    @property
    def exponent_errors(self) -> NDArray[Any]:
        """Error of each exponent, 1/time. Read-only."""
    @property
    def growth_rate(self) -> float:
        """Largest real part, 1/time: above 0 disturbances grow."""
    @property
    def growth_error(self) -> float:
        """Error of growth_rate, the larger half of growth_interval."""
    @property
    def growth_interval(self) -> tuple[float, float]:
        """(low, high) between which the growth rate lies: what the verdict rests on."""
    @property
    def verdict(self) -> str:
        """ "stable", "bounded", "unstable" or "undecided"."""
    @property
    def converged(self) -> bool:
        """Whether growth_error is within what was asked."""
    @property
    def method(self) -> str:
        """The method that gave the growth rate."""
    @property
    def evidence(self) -> str:
        """One sentence: what was done."""

class Rod:
    """The response and stability of one elastic link at one speed."""

    @property
    def name(self) -> str:
        """Its name."""
    @property
    def modes(self) -> int:
        """Number of Ritz terms I."""
    @property
    def harmonics(self) -> Optional[int]:
        """Number of harmonics H; None without a steady state."""
    @property
    def q(self) -> Any:
        """Fourier coefficients c_n of every q_i over the crank angle, (I, H+1) complex, read-only, in the scene's
        unit of length: q_i(t) = sum_n c_n exp(i n Omega t), c_-n = conj(c_n)."""
    @property
    def max_abs(self) -> Any:
        """Largest |q_i| over the turn, (I,), read-only."""
    @property
    def crank_angle(self) -> Any:
        """Where |q_i| is largest, (I,), in the scene's unit of angle."""
    @property
    def error_bound(self) -> Optional[float]:
        """Bound on max |error of q| / max |q| for this number of modes."""
    @property
    def modes_error(self) -> Optional[float]:
        """Estimated relative error of the deflection from cutting the Ritz series; None: not asked."""
    @property
    def theory_error(self) -> Optional[float]:
        """By how much the linear theory itself is off, relative; None: beyond it, or not judged."""
    @property
    def stability(self) -> Optional[Stability]:
        """Everything known of its stability; None: not computed."""
    @property
    def exponents(self) -> Any:
        """Floquet exponents, 1/time, read-only; see Stability."""
    @property
    def exponent_errors(self) -> Any:
        """Error of each exponent, read-only."""
    @property
    def growth_rate(self) -> Optional[float]:
        """Largest real part of the exponents, 1/time."""
    @property
    def growth_error(self) -> Optional[float]:
        """Error of the growth rate."""
    @property
    def verdict(self) -> Optional[str]:
        """ "stable", "bounded", "unstable" or "undecided"; None: not computed."""
    def response(self, angle: ArrayLike) -> NDArray[Any]:
        """q_i at crank angles in the scene's unit: (I, len(angle))."""
    def deflection(self, x: ArrayLike, angle: ArrayLike) -> Any:
        """Deflection at x from joint 0, (len(x), len(angle)), in the scene's unit of length; to the left positive."""
    def bending_moment(self, x: ArrayLike, angle: ArrayLike) -> Any:
        """Bending moment EJ w'' at x, (len(x), len(angle)), in the scene's units."""
    def to_dict(self) -> dict[str, Any]:
        """Its entry under "rods" of `hb steady --json`."""
    def to_frame(self, what: str = "response") -> pandas.DataFrame:
        """A table of the command: "response", "fourier", "deflection", "bending_moment" or "exponents"."""
    def plot(self, kind: str = "response", ax: Optional[Axes] = None) -> Axes:
        """Draws "response", "spectrum", "phase", "deflection", "bending_moment" or "exponents"."""
    def _table(self, what: str, /) -> _Table: ...
    @property
    def _owner(self) -> Answer: ...
    @property
    def _index(self) -> int: ...
    def __reduce__(self) -> tuple[Any, ...]: ...

class Force:
    """A joint's force, or the driving torque, over the turn, in the scene's units."""

    def elastic(self, angle: ArrayLike) -> Any:
        """With the links' elasticity: (2, len(angle)); guides and torque (len(angle),)."""
    def rigid(self, angle: ArrayLike) -> Any:
        """Of the rigid mechanism, shaped as elastic(angle)."""
    @property
    def elastic_series(self) -> NDArray[Any]:
        """Fourier coefficients over the crank angle, (components, harmonics + 1) complex, read-only."""
    @property
    def rigid_series(self) -> NDArray[Any]:
        """Fourier coefficients of the rigid mechanism."""

class Answer:
    origin: tuple[Any, tuple[Any, ...]]
    @property
    def omega(self) -> float: ...
    @property
    def verdict(self) -> Optional[str]: ...
    @property
    def shortfalls(self) -> list[str]: ...
    @property
    def stability(self) -> Optional[Stability]: ...
    def rods(self) -> dict[str, Rod]: ...
    def rod(self, rod: int, /) -> Rod: ...
    def joints(self) -> dict[str, Force]: ...
    def torque(self) -> Optional[Force]: ...
    def json(self) -> str: ...
    def words(self) -> str: ...
    def table(self, what: str, /) -> _Table: ...

class Sweep:
    def json(self) -> str: ...
    def words(self) -> str: ...
    @property
    def shortfalls(self) -> list[str]: ...
    def rod_table(self, rod: str, /) -> _Table: ...
    def forces_table(self) -> _Table: ...
    def columns(self, rod: str, /) -> dict[str, int]: ...
    def axis_label(self) -> str: ...

class Map:
    def json(self) -> str: ...
    def words(self) -> str: ...
    def table(self) -> _Table: ...
    @property
    def evidence(self) -> str: ...

class Check:
    @property
    def agrees(self) -> bool: ...
    @property
    def shortfalls(self) -> list[str]: ...
    def json(self) -> str: ...
    def words(self) -> str: ...

class Tune:
    def json(self) -> str: ...
    def words(self) -> str: ...
    def table(self) -> _Table: ...
    def scene_text(self, name: str, folder: str, /) -> str: ...
    @property
    def shortfall(self) -> str: ...
    @property
    def remarks(self) -> list[str]: ...

class HillSystem:
    def __init__(
        self,
        mass: Any,
        damping: Any,
        stiffness_harmonics: list[Any],
        stiffness_samples: list[Any],
        load_harmonics: list[Any],
        load_samples: list[Any],
        /,
    ) -> None: ...
    @property
    def size(self) -> int: ...
    @property
    def mass(self) -> NDArray[Any]: ...
    @property
    def damping(self) -> NDArray[Any]: ...
    def stiffness_series(self, power: int, /) -> NDArray[Any]: ...
    def load_series(self, power: int, /) -> NDArray[Any]: ...
    def steady(self, arguments: dict[str, Any]) -> Answer: ...
    def stability(self, omega: Any, rpm: Any, tol: Any, stability_method: Any, /) -> Stability: ...

def steady(scene: Scene, arguments: dict[str, Any]) -> Answer: ...
def sweep(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Sweep: ...
def map(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Map: ...
def check(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Check: ...
def tune(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Tune: ...
def steady_report(scene: Scene, answer: Answer, file: str, call: str) -> None: ...
def sweep_report(
    scene: Scene, sweep: Sweep, map: Union[Map, None], file: str, call: str, pictures: bool, threads: int
) -> None: ...
def map_report(scene: Scene, map: Map, file: str, call: str) -> None: ...
def tune_report(scene: Scene, tune: Tune, file: str, call: str) -> None: ...
