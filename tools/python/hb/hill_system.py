"""Any linear system with periodic coefficients."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Optional, Union

from . import _core
from ._core import Rod, Stability
from .errors import refused

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .scene import Scene

Terms = Union[Mapping[Any, Any], "ArrayLike", Callable[[float], "ArrayLike"], None]

_MOST_HARMONIC = 10000


class HillSystem:
    """M q'' + B q' + C(Omega t) q = h(Omega t), ' = d/dt, of n unknowns.

    mass, damping (default 0): (n, n). stiffness and load are one of

    - a dict of harmonics: {0: C0, 1: (C1cos, C1sin), 2: C2cos}, sum of C_k,cos cos(k tau) + C_k,sin sin(k tau) with
      tau = Omega t; a key (k, p) stands for a term times Omega^p, p = 0, 1, 2;
    - samples over one turn, (N, n, n) or, of a load, (N, n), at tau = 2 pi j/N; N >= 3;
    - a function of tau (rad) that gives an (n, n) matrix or, of a load, n numbers: sampled until its series has decayed.

    Of one unknown, plain numbers do for matrices.
    """

    def __init__(
        self, *, mass: "ArrayLike", damping: Optional["ArrayLike"] = None, stiffness: Terms, load: Terms = None
    ) -> None:
        mass = _square("mass", mass)
        size = len(mass)
        damping = None if damping is None else _square("damping", damping)
        c_terms, c_samples = _terms("stiffness", stiffness, (size, size))
        h_terms, h_samples = _terms("load", load, (size,))
        self._parts: tuple[Any, ...] = (mass, damping, c_terms, c_samples, h_terms, h_samples)
        self._make()

    def _make(self) -> None:
        self._core = _core.HillSystem(*self._parts)
        self._stability = self._core.stability  # looked up once: called in loops

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return self._core.size

    @property
    def mass(self) -> "NDArray[Any]":
        """(n, n), read-only."""
        return self._core.mass

    @property
    def damping(self) -> "NDArray[Any]":
        """(n, n), read-only."""
        return self._core.damping

    def stiffness_series(self, power: int = 0) -> "NDArray[Any]":
        """Fourier coefficients of the stiffness that goes with Omega^power, (n*n, H+1) complex, read-only: the entry
        (i, k) is row i + n k. (0, 0) where there is none."""
        return self._core.stiffness_series(_power(power))

    def load_series(self, power: int = 0) -> "NDArray[Any]":
        """Fourier coefficients of the load that goes with Omega^power, (n, H+1) complex, read-only."""
        return self._core.load_series(_power(power))

    def steady(
        self,
        *,
        omega: Optional[Union[float, str]] = None,
        rpm: Optional[Union[float, str]] = None,
        tol: Optional[float] = None,
        steady_method: Optional[str] = None,
        bound: Optional[str] = None,
    ) -> Rod:
        """The periodic solution at omega (rad per unit time) as an hb.Rod: q, response, max_abs, error_bound."""
        arguments = {"omega": omega, "rpm": rpm, "tol": tol, "steady_method": steady_method, "bound": bound}
        answer = _answer(self, arguments)
        answer.origin = (_answer, (self, arguments))
        return answer.rod(0)

    def stability(
        self,
        *,
        omega: Optional[Union[float, str]] = None,
        rpm: Optional[Union[float, str]] = None,
        tol: Optional[float] = None,
        stability_method: Optional[str] = None,
    ) -> Stability:
        """Floquet exponents at omega (rad per unit time) with their errors, growth rate and verdict."""
        return self._stability(omega, rpm, tol, stability_method)

    def to_scene(self, title: str = "") -> "Scene":
        """The same as a [hill] scene, for sweeps, maps and the command. Only of harmonics, not of samples."""
        from .scene import Scene

        mass, damping, c_terms, c_samples, h_terms, h_samples = self._parts
        if c_samples or h_samples:
            raise refused("stiffness, load", "samples", "harmonics, as numbers of a scene")

        def listed(terms: list[tuple[int, int, Any, Any]]) -> list[dict[str, Any]]:
            return [
                {"harmonic": k, "omega_power": p}
                | ({} if cos is None else {"cos": cos.tolist()})
                | ({} if sin is None else {"sin": sin.tolist()})
                for k, p, cos, sin in terms
            ]

        hill: dict[str, Any] = {"mass": mass.tolist(), "stiffness": listed(c_terms)}
        if damping is not None:
            hill["damping"] = damping.tolist()
        if h_terms:
            hill["load"] = listed(h_terms)
        scene: dict[str, Any] = {"title": title} if title else {}
        return Scene.from_dict(scene | {"hill": hill})

    def __repr__(self) -> str:
        return f"<hb.HillSystem of {self.size} unknown{'s' if self.size != 1 else ''}>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_parts, (self._parts,)


def _from_parts(parts: tuple[Any, ...]) -> HillSystem:
    system = HillSystem.__new__(HillSystem)
    system._parts = parts
    system._make()
    return system


def _answer(system: HillSystem, arguments: dict[str, Any]) -> _core.Answer:
    return system._core.steady(arguments)


def _power(power: int) -> int:
    if power not in (0, 1, 2):
        raise refused("power", power, "0, 1 or 2")
    return int(power)


def _array(field: str, given: Any) -> "NDArray[Any]":
    import numpy

    try:
        array = numpy.asarray(given)
    except ValueError:
        array = numpy.asarray(None)
    if array.dtype.kind not in "iuf":
        raise refused(field, repr(given), "an array of numbers")
    return numpy.array(array, dtype=float)  # a copy: what is given may change later


def _square(field: str, given: Any) -> "NDArray[Any]":
    array = _array(field, given)
    return array.reshape(1, 1) if array.ndim == 0 else array


def _shaped(field: str, given: Any, shape: tuple[int, ...]) -> Any:
    if given is None:
        return None
    array = _array(field, given)
    if array.ndim == 0 and max(shape) == 1:
        return array.reshape(shape)
    if array.ndim != len(shape):
        raise refused(field, f"an array of shape {array.shape}", f"shape {shape}, as mass has {shape[0]} rows")
    return array


def _terms(field: str, terms: Terms, shape: tuple[int, ...]) -> tuple[list[Any], list[Any]]:
    """Lists of (harmonic, power, cos, sin) and of (power, samples)."""
    if terms is None:
        if field == "stiffness":
            raise refused(field, "None", "a dict of harmonics, samples, or a function of tau")
        return [], []
    if callable(terms):
        return [], [(0, _sampled(field, terms, shape))]
    if not isinstance(terms, Mapping):
        samples = _array(field, terms)
        if samples.ndim == 1 and max(shape) == 1:
            samples = samples.reshape(-1, *shape)
        if samples.ndim != len(shape) + 1 or samples.shape[1:] != shape or len(samples) < 3:
            sizes = ", ".join(str(n) for n in shape)
            raise refused(field, f"samples of shape {samples.shape}", f"shape (N, {sizes}) with N >= 3")
        return [], [(0, samples.reshape(len(samples), -1))]
    listed = []
    for key, value in terms.items():
        harmonic, power = key if isinstance(key, tuple) and len(key) == 2 else (key, 0)
        if not (_is_integer(harmonic) and 0 <= harmonic <= _MOST_HARMONIC and _is_integer(power) and 0 <= power <= 2):
            allowed = f"a harmonic k, 0 to {_MOST_HARMONIC}, or (k, p) with a power p = 0, 1, 2 of Omega"
            raise refused(f"{field} key", repr(key), allowed)
        name = f"{field}[{key!r}]"
        cos, sin = value if isinstance(value, tuple) and len(value) == 2 else (value, None)
        cos, sin = _shaped(name, cos, shape), _shaped(name, sin, shape)
        if cos is None and sin is None:
            raise refused(name, value, "an array, or a pair (cos, sin)")
        if harmonic == 0 and sin is not None and sin.any():
            raise refused(name, "a sine of harmonic 0", "an array")
        listed.append((int(harmonic), int(power), cos, sin))
    return listed, []


def _is_integer(number: Any) -> bool:
    return hasattr(number, "__index__") and not isinstance(number, bool)


def _sampled(field: str, function: Callable[[float], Any], shape: tuple[int, ...]) -> "NDArray[Any]":
    """As many samples as its Fourier series needs to decay to rounding, 4096 at most."""
    import numpy

    def sample(tau: float) -> "NDArray[Any]":
        array = _shaped(field, function(tau), shape)
        if array is None or array.shape != shape:
            found = "None" if array is None else f"shape {array.shape}"
            raise refused(f"{field}({tau:.6g})", found, f"shape {shape}")
        return array

    count = 16
    values = [sample(2 * numpy.pi * j / count) for j in range(count)]
    while True:
        spectrum = numpy.abs(numpy.fft.rfft(numpy.array(values), axis=0))
        tail = spectrum[3 * count // 8 :].max()
        if not numpy.isfinite(tail) or tail <= 1e-14 * spectrum.max() or count >= 4096:
            return numpy.array(values).reshape(count, -1)
        between = [sample(2 * numpy.pi * (j + 0.5) / count) for j in range(count)]
        values = [value for pair in zip(values, between) for value in pair]
        count *= 2
