"""The compiled half of the package hb: scenes, analyses and their results."""

from typing import Any, Callable, Optional, Union

import pandas
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from .machine_loads import AxialForce, NearestResonance, Peak, Stress

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
    def frequencies_hz(self) -> NDArray[Any]:
        """Frequency of each exponent, unfolded, Hz. Read-only."""
    @property
    def frequencies_hz_errors(self) -> NDArray[Any]:
        """Their errors, Hz. Read-only."""
    @property
    def damping_ratios(self) -> NDArray[Any]:
        """-Re/|exponent| of each at its frequency. Read-only."""
    @property
    def damping_ratio_errors(self) -> NDArray[Any]:
        """Their errors. Read-only."""
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
    def shortfalls(self) -> list[str]:
        """What missed the tolerance, a sentence each."""
    @property
    def method(self) -> str:
        """The method that gave the growth rate."""
    @property
    def evidence(self) -> str:
        """One sentence: what was done."""
    def to_dict(self) -> dict[str, Any]:
        """The same keys as under "rods" of `hb steady --json`."""
    def to_frame(self) -> pandas.DataFrame:
        """A pandas DataFrame with a row for each exponent."""
    def plot(self, ax: Optional[Axes] = None) -> Axes:
        """Draws the exponents with their errors in the complex plane."""

class Rod:
    """The response and stability of one elastic link at one speed."""

    @property
    def name(self) -> str:
        """Its name."""
    @property
    def modes(self) -> int:
        """Number of Ritz terms I."""
    @property
    def converged(self) -> bool:
        """Whether what was asked of it reached the tolerance; if not, `shortfalls` says what did not."""
    @property
    def shortfalls(self) -> list[str]:
        """What missed the tolerance, a sentence each."""
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
    @property
    def deflection_peak(self) -> Optional[Peak]:
        """Largest |w| over rod and turn, and where; relative error: modes_error. None: not computed."""
    @property
    def bending_moment_peak(self) -> Optional[Peak]:
        """Largest bending moment over rod and turn, and where; None: not computed."""
    @property
    def static_deflection(self) -> Optional[Peak]:
        """Largest deflection of the mechanism at rest, with its error; None: not computed, or the rod would buckle."""
    @property
    def axial_force(self) -> Optional[AxialForce]:
        """Largest pull and push, and the share of the buckling load; None: not computed."""
    @property
    def stress(self) -> Optional[Stress]:
        """Largest stress, widest cycle, safeties against yielding and fatigue, with errors; None: not computed."""
    @property
    def nearest_resonance(self) -> Optional[NearestResonance]:
        """The nearest speed at which a natural frequency is met; None: not computed, or none."""
    @property
    def frequencies(self) -> Any:
        """Frequency of each exponent, unfolded, rad per unit time, read-only; None: not computed."""
    @property
    def multipliers(self) -> Any:
        """Floquet multiplier of each exponent, complex, read-only; None: not computed."""
    @property
    def frequencies_hz(self) -> Any: ...
    @property
    def frequencies_hz_errors(self) -> Any: ...
    @property
    def damping_ratios(self) -> Any: ...
    @property
    def damping_ratio_errors(self) -> Any: ...
    @property
    def strain(self) -> Optional[float]:
        """Largest strain, axial and bending added; None: not computed."""
    @property
    def amplification(self) -> Optional[float]:
        """Largest |q| against that of the same load applied slowly; None: no value."""
    @property
    def resonance_distance(self) -> Optional[float]:
        """Smallest singular value of the scaled balance: 0 at a resonance."""
    @property
    def status(self) -> Optional[str]:
        """Of the periodic solution, in words; None: not computed."""
    @property
    def steady_method(self) -> Optional[str]:
        """How the periodic solution was found."""
    @property
    def residual(self) -> Optional[float]:
        """Relative residual of the periodic solution."""
    @property
    def error_bound_proved(self) -> Optional[bool]:
        """Whether error_bound is proved, not estimated."""
    @property
    def more_modes_needed(self) -> Optional[bool]:
        """Whether modes_error is above 0.01; None: not asked."""
    @property
    def theory(self) -> Optional[str]:
        """ "within", "beyond" or "not judged"; None of a [hill] system."""
    @property
    def deflection_theory_error(self) -> Optional[float]:
        """theory_error of the deflection; None: beyond, or not judged."""
    @property
    def theory_axial_share(self) -> Optional[float]:
        """What axial elasticity would change of theory_error, a share of it, a rough estimate; or None."""
    @property
    def exponents_unresolved(self) -> Optional[int]:
        """How many exponents were looked for and not resolved."""
    @property
    def exponents_uncertain(self) -> Any:
        """Exponents with bars too wide, as in the document: exponent and error of each; None: not computed."""
    @property
    def growth_modes(self) -> Optional[int]:
        """Number of Ritz terms of the exponents; None: not computed."""
    @property
    def growth_modes_error(self) -> Optional[float]:
        """Estimated relative error of the growth rate from the modes left out; None: not asked."""
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

    @property
    def error(self) -> Optional[float]:
        """Estimated error of the elastic values, modes left out included; None: not known."""
    @property
    def mean_theory_error(self) -> Optional[float]:
        """Of the driving torque, what the first nonlinear correction changes of its mean; None: no value, not judged, or without linearisation."""
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
    @property
    def min(self) -> Any:
        """Smallest value over the turn: (2,); guides and torque a number."""
    @property
    def max(self) -> Any:
        """Largest value over the turn: (2,); guides and torque a number."""
    @property
    def mean(self) -> Any:
        """Mean over the turn: (2,); guides and torque a number."""
    @property
    def rms(self) -> Any:
        """Root of the mean square over the turn: (2,); guides and torque a number."""
    @property
    def min_rigid(self) -> Any:
        """Smallest value over the turn of the rigid mechanism: (2,); guides and torque a number."""
    @property
    def max_rigid(self) -> Any:
        """Largest value over the turn of the rigid mechanism: (2,); guides and torque a number."""
    @property
    def mean_rigid(self) -> Any:
        """Mean over the turn of the rigid mechanism: (2,); guides and torque a number."""
    @property
    def rms_rigid(self) -> Any:
        """Root of the mean square over the turn of the rigid mechanism: (2,); guides and torque a number."""

class Answer:
    origin: tuple[Any, tuple[Any, ...]]
    document: dict[str, Any]
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

class Bench:
    def json(self) -> str: ...
    def words(self) -> str: ...
    @property
    def shortfalls(self) -> list[str]: ...

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

def fit_decay(t: ArrayLike, x: ArrayLike) -> tuple[float, float, float, float, float, NDArray[Any]]: ...
def fit_peak(omega: ArrayLike, amplitude: ArrayLike) -> tuple[float, float, float, float, float, NDArray[Any]]: ...
def steady(scene: Scene, arguments: dict[str, Any]) -> Answer: ...
def sweep(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Sweep: ...
def map(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Map: ...
def bench(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Bench: ...
def check(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Check: ...
def tune(scene: Scene, arguments: dict[str, Any], progress: _Progress) -> Tune: ...
def steady_report(scene: Scene, answer: Answer, file: str, call: str) -> None: ...
def sweep_report(
    scene: Scene, sweep: Sweep, map: Union[Map, None], file: str, call: str, pictures: bool, threads: int
) -> None: ...
def map_report(scene: Scene, map: Map, file: str, call: str) -> None: ...
def tune_report(scene: Scene, tune: Tune, file: str, call: str) -> None: ...
