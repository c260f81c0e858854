"""Periodic vibration and dynamic stability of linkages with elastic links, by harmonic balance.

    m = hb.load("six_link.toml")
    s = m.steady(rpm=300)
    s["AB"].verdict, s["AB"].max_abs

Numbers are those of the command `hb`, to the last bit; units are the scene's.
"""

from ._core import Force, Rod, Stability
from ._core import version as __version__
from .bench import Bench, RodBench
from .check import Check, RodCheck
from .errors import Error, MissingPackage, RequestError, SceneError, SceneProblem
from .fit import DampingFit, fit_decay, fit_peak
from .hill_system import HillSystem
from . import stability as _stability  # adds to Stability
from .map import Boundary, Map, RodMap
from .scene import Scene, load, loads
from .steady import Steady
from .sweep import CriticalPoint, Sweep, SweepRod
from .tune import Tune

__all__ = [
    "Bench",
    "Boundary",
    "Check",
    "CriticalPoint",
    "DampingFit",
    "Error",
    "Force",
    "HillSystem",
    "Map",
    "MissingPackage",
    "RequestError",
    "Rod",
    "RodBench",
    "RodCheck",
    "RodMap",
    "Scene",
    "SceneError",
    "SceneProblem",
    "Stability",
    "Steady",
    "Sweep",
    "SweepRod",
    "Tune",
    "__version__",
    "fit_decay",
    "fit_peak",
    "load",
    "loads",
]
