"""Whatever is given: an answer, or an exception of the package or of Python's own that says so; never a crash."""

import copy
import gc
import math

import numpy as np
import pytest
from conftest import SCENES

import hb

STRANGE = [
    None,
    "",
    "x" * 100000,
    "\ud800",
    "\0",
    b"x",
    [],
    {},
    (),
    object(),
    float("nan"),
    float("inf"),
    -1,
    0,
    10**400,
    1e-320,
    1j,
    np.array(None),
    np.zeros((2, 0)),
    np.zeros((1, 1, 1)),
    np.array([math.nan]),
    lambda *a: 1,
    (1, 2, 3, 4),
    [[1], [2, 3]],
    (None, None, None),
    ("rpm", None),
    {1: 2},
]
TOLD = (hb.Error, TypeError, KeyError, OSError)


def ask(function, *arguments, **named):
    try:
        function(*arguments, **named)
    except TOLD as error:
        assert str(error)


@pytest.mark.parametrize("k", range(len(STRANGE)))
def test_strange_arguments_are_told(steady, six_link, k):
    strange = STRANGE[k]
    rod, force = steady["AB"], steady.torque
    system = hb.HillSystem(mass=1, stiffness={0: 2})
    for name in ("omega", "modes", "tol", "rods", "only", "theory", "period", "steady_method", "stability_method", "bound"):
        ask(six_link.steady, **{"rpm": 300, "only": "steady", "modes": 1, name: strange} | ({"rpm": None} if name == "omega" else {}))
    if strange is not None:
        for name in ("rpm", "omega", "x"):
            ask(six_link.sweep, **{name: strange})
        ask(six_link.map, x=strange, y="AB.J=1:2:2")
        ask(six_link.map, x="rpm=1:2:2", y=strange)
        ask(six_link.check, rpm=300, integrator=strange, case_limit=strange)
        for name in ("vary", "keep", "over", "tie", "height", "minimise", "modes", "seed"):
            ask(six_link.tune, **{"minimise": "mass", "vary": {"AB.J": (1, "x")}, name: strange})
    for function in (rod.response, force.elastic, force.rigid, hb.load, hb.loads, hb.Scene.from_dict, six_link.with_):
        ask(function, strange)
    ask(rod.deflection, strange, 0)
    ask(rod.deflection, 0, strange)
    ask(six_link.__getitem__, strange)
    ask(six_link.with_, {"AB.J": strange})
    ask(steady.__getitem__, strange if strange.__hash__ else "x")
    for name in ("mass", "damping", "stiffness", "load"):
        ask(hb.HillSystem, **{"mass": 1, "stiffness": {0: 2}, name: strange})
        if name in ("stiffness", "load"):
            ask(hb.HillSystem, **{"mass": 1, "stiffness": {0: 2}, name: {0: strange}})
            ask(hb.HillSystem, **{"mass": 1, "stiffness": {0: 2}, name: {1: (strange, strange)}})
    ask(system.steady, omega=strange)
    ask(system.stability, omega=strange)
    ask(system.stability, omega=1, tol=strange)


def test_views_outlive_results_scenes_and_systems():
    def views():
        scene = hb.load(SCENES / "slider_crank.toml").with_({"analysis.modes": 2})
        steady = scene.steady(rpm=1000)
        rod = steady["rod"]
        system = hb.HillSystem(mass=1, damping=0.1, stiffness={0: 1.2, 1: 0.4}, load={1: 1})
        stability = system.stability(omega=2.1)
        return [
            rod.q,
            rod.max_abs,
            rod.exponents,
            rod.exponent_errors,
            rod.stability.exponents,
            steady.torque.elastic_series,
            steady.joints["piston.guide"].rigid_series,
            system.mass,
            system.stiffness_series(),
            system.steady(omega=1).q,
            stability.exponents,
            rod.response,
            steady.joints["rod.0"].elastic,
        ]

    kept = views()
    gc.collect()
    junk = [bytearray(1000) for _ in range(1000)]
    again = views()
    for one, other in zip(kept, again):
        if callable(one):
            one, other = one([0, 90]), other([0, 90])
        assert np.array_equal(one, other)
    del junk


def test_objects_that_were_not_made_are_told():
    for kind in (hb.Rod, hb.Force, hb.Stability):
        with pytest.raises(TypeError):
            kind()


def test_what_does_not_pickle_says_so(steady):
    for part in (steady.torque, steady["AB"].stability):
        with pytest.raises(TypeError, match="pickle"):
            copy.copy(part)


def test_copies_are_equal(steady):
    assert copy.deepcopy(steady).to_dict() == steady.to_dict()
    assert (copy.copy(steady["AB"]).q == steady["AB"].q).all()
