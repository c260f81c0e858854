"""Linear periodic systems from arrays: the numbers of a [hill] scene, and of known systems."""

import pickle

import numpy as np
import pytest
from conftest import SCENES

import hb

M = np.array([[2.0, 0.3], [0.3, 1.0]])
B = np.array([[0.05, 0.01], [0.0, 0.08]])
C0 = np.array([[3.0, 0.2], [0.2, 7.0]])
C1 = (np.array([[0.4, 0.1], [0.1, 0.2]]), np.array([[0.0, 0.3], [0.3, 0.1]]))
LOAD = {1: (np.array([1.0, 0.5]), np.array([0.0, 0.2])), 0: np.array([0.3, -0.1])}


@pytest.fixture(scope="module")
def system():
    return hb.HillSystem(mass=M, damping=B, stiffness={0: C0, 1: C1}, load=LOAD)


def test_arrays_and_a_scene_are_one_system(system):
    scene = system.to_scene("the same")
    for omega in (0.7, 2.1):
        rod = scene.steady(omega=omega)["system"]
        alone = system.steady(omega=omega)
        assert (alone.q == rod.q).all() and (alone.max_abs == rod.max_abs).all()
        assert alone.error_bound == rod.error_bound
        stability = system.stability(omega=omega)
        assert (stability.exponents == rod.exponents).all()
        assert (stability.exponent_errors == rod.exponent_errors).all()
        assert stability.growth_rate == rod.growth_rate and stability.growth_error == rod.growth_error
        assert stability.verdict == rod.verdict
        entry = rod.to_dict()
        for key, value in stability.to_dict().items():
            assert entry[key] == value, key


def test_exponents_are_a_table_and_a_picture(system):
    stability = system.stability(omega=0.7)
    frame = pytest.importorskip("pandas") and stability.to_frame()
    assert (frame["error"].to_numpy() == stability.exponent_errors).all() and len(frame) == 4
    pytest.importorskip("matplotlib").use("Agg")
    axes = stability.plot()
    assert stability.verdict in axes.get_title(loc="left")


def test_the_steady_state_solves_the_equation(system):
    omega = 1.3
    rod = system.steady(omega=omega)
    tau = np.linspace(0, 2 * np.pi, 50)
    n = np.arange(rod.q.shape[1])

    def series(order):
        terms = rod.q * np.where(n == 0, 1, 2) * (1j * n * omega) ** order
        return (terms @ np.exp(1j * np.outer(n, tau))).real

    C = C0[:, :, None] + C1[0][:, :, None] * np.cos(tau) + C1[1][:, :, None] * np.sin(tau)
    h = LOAD[0][:, None] + LOAD[1][0][:, None] * np.cos(tau) + LOAD[1][1][:, None] * np.sin(tau)
    residual = M @ series(2) + B @ series(1) + np.einsum("ikt,kt->it", C, series(0)) - h
    assert np.abs(residual).max() <= 1e-8
    assert np.abs(rod.response(tau) - series(0)).max() <= 1e-13 * rod.max_abs.max()


def test_numbers_do_for_one_unknown():
    x = hb.HillSystem(mass=1, damping=0.1, stiffness={0: 1.2, 1: 0.4}, load={1: 1})
    scene = hb.load(SCENES / "mathieu.toml")
    assert (x.steady(omega=1).q == scene.steady(omega=1)["system"].q).all()
    assert x.stability(omega=2.1).verdict == scene.steady(omega=2.1)["system"].verdict == "unstable"


def test_samples_and_functions_are_the_series(system):
    def stiffness(tau):
        return C0 + C1[0] * np.cos(tau) + C1[1] * np.sin(tau)

    def load(tau):
        return LOAD[0] + LOAD[1][0] * np.cos(tau) + LOAD[1][1] * np.sin(tau)

    tau = 2 * np.pi * np.arange(9) / 9
    samples = np.array([stiffness(t) for t in tau]), np.array([load(t) for t in tau])
    for c, h in [(stiffness, load), samples]:
        other = hb.HillSystem(mass=M, damping=B, stiffness=c, load=h)
        found, expected = other.steady(omega=1.3), system.steady(omega=1.3)
        assert np.abs(found.response(tau) - expected.response(tau)).max() <= 1e-12
        assert other.stability(omega=1.3).growth_rate == pytest.approx(system.stability(omega=1.3).growth_rate, rel=1e-8)


def test_a_function_with_a_kink_is_sampled_far(system):
    saw = hb.HillSystem(mass=1, damping=0.2, stiffness=lambda tau: 2 + abs(np.sin(tau / 2)))
    assert saw.stiffness_series().shape[1] > 1000


def test_powers_of_the_speed_go_with_it():
    omega = 1.7
    by_power = hb.HillSystem(mass=1, damping=0.1, stiffness={0: 1.0, (0, 1): 0.2, (1, 2): (0.3, 0.1)}, load={(1, 2): 1.0})
    plain = hb.HillSystem(
        mass=1, damping=0.1, stiffness={0: 1.0 + 0.2 * omega, 1: (0.3 * omega**2, 0.1 * omega**2)}, load={1: omega**2}
    )
    assert np.abs(by_power.steady(omega=omega).q - plain.steady(omega=omega).q).max() <= 1e-14
    found, expected = by_power.stability(omega=omega), plain.stability(omega=omega)
    assert abs(found.growth_rate - expected.growth_rate) <= found.growth_error + expected.growth_error
    scene = by_power.to_scene()
    assert (scene.steady(omega=omega)["system"].q == by_power.steady(omega=omega).q).all()


def test_exponents_of_constant_coefficients_are_eigenvalues():
    system = hb.HillSystem(mass=M, damping=B, stiffness={0: C0})
    omega = 100.0  # nothing is folded
    companion = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, C0), -np.linalg.solve(M, B)]])
    expected = np.linalg.eigvals(companion)
    stability = system.stability(omega=omega)
    for value, error in zip(stability.exponents, stability.exponent_errors):
        assert np.abs(expected - value).min() <= error + 1e-13
    assert stability.verdict == "stable"


def test_what_was_given_may_change_later():
    mass = np.eye(2)
    system = hb.HillSystem(mass=mass, stiffness={0: C0})
    mass[:] = 0
    assert (system.mass == np.eye(2)).all()
    assert not system.mass.flags.writeable


def test_no_damping_is_bounded():
    assert hb.HillSystem(mass=1, stiffness={0: 3.3}).stability(omega=1).verdict == "bounded"


def test_pickles_have_the_same_bits(system):
    again = pickle.loads(pickle.dumps(system))
    assert (again.steady(omega=1.1).q == system.steady(omega=1.1).q).all()
    rod = pickle.loads(pickle.dumps(system.steady(omega=1.1)))
    assert (rod.q == system.steady(omega=1.1).q).all()


@pytest.mark.parametrize(
    "arguments, field",
    [
        ({"mass": [[1, 2]]}, "mass"),
        ({"mass": np.zeros((0, 0))}, "mass"),
        ({"mass": np.zeros((2, 2))}, "mass"),
        ({"mass": np.full((2, 2), np.nan)}, "mass"),
        ({"mass": "x"}, "mass"),
        ({"mass": [[1], [1, 2]]}, "mass"),
        ({"mass": np.eye(2) * 1j}, "mass"),
        ({"mass": np.ones((2, 2, 2))}, "mass"),
        ({"damping": np.eye(3)}, "damping"),
        ({"damping": [1, 2]}, "damping"),
        ({"damping": [[np.inf, 0], [0, 1]]}, "damping"),
        ({"stiffness": {0: np.eye(3)}}, "stiffness[0]"),
        ({"stiffness": {0: np.array([1, 2])}}, "stiffness[0]"),
        ({"stiffness": {0: [[np.nan, 0], [0, 1]]}}, "stiffness[0]"),
        ({"stiffness": {0: (C0, C0)}}, "stiffness[0]"),
        ({"stiffness": {1: (None, None)}}, "stiffness[1]"),
        ({"stiffness": {-1: C0}}, "stiffness key"),
        ({"stiffness": {(0, 3): C0}}, "stiffness key"),
        ({"stiffness": {0.5: C0}}, "stiffness key"),
        ({"stiffness": {10**9: C0}}, "stiffness key"),
        ({"stiffness": None}, "stiffness"),
        ({"stiffness": np.zeros((2, 2, 2))}, "stiffness"),
        ({"stiffness": np.zeros((5, 3, 3))}, "stiffness"),
        ({"stiffness": np.full((5, 2, 2), np.nan)}, "stiffness"),
        ({"stiffness": lambda tau: [1, 2, 3]}, "stiffness"),
        ({"stiffness": lambda tau: np.full((2, 2), np.nan)}, "stiffness"),
        ({"load": {1: [1.0]}}, "load[1]"),
        ({"load": {1: np.eye(2)}}, "load[1]"),
        ({"load": np.zeros((5, 3))}, "load"),
        ({"load": 3.0}, "load"),
    ],
)
def test_wrong_systems_are_refused_by_name(arguments, field):
    with pytest.raises(hb.RequestError) as raised:
        hb.HillSystem(**{"mass": M, "damping": B, "stiffness": {0: C0}, **arguments})
    assert raised.value.field == field
    assert raised.value.found and raised.value.allowed


def test_errors_of_functions_come_through():
    def wrong(tau):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        hb.HillSystem(mass=1, stiffness=wrong)


@pytest.mark.parametrize("omega", [0, -1, float("nan"), float("inf"), "1", None])
def test_wrong_speeds_are_refused(system, omega):
    for method in (system.steady, system.stability):
        with pytest.raises(hb.RequestError):
            method(omega=omega)


def test_shapes_are_answered_with_those_of_mass():
    with pytest.raises(hb.RequestError) as raised:
        hb.HillSystem(mass=np.eye(2), stiffness={0: 1})
    assert raised.value.field == "stiffness[0]" and "(2, 2)" in raised.value.allowed
    with pytest.raises(hb.RequestError, match="0 to 10000"):
        hb.HillSystem(mass=1, stiffness={20000: 1})
    with pytest.raises(hb.RequestError) as raised:
        hb.HillSystem(mass=0, stiffness={0: 1})
    assert raised.value.found == "mass is singular"
    with pytest.raises(hb.RequestError) as raised:
        hb.HillSystem(mass="a", stiffness={0: 1})
    assert raised.value.found == "'a'"
    with pytest.raises(hb.RequestError) as raised:
        hb.HillSystem(mass=np.eye(9) * 1j, stiffness={0: np.eye(9)})
    assert "\n" not in str(raised.value) and len(raised.value.found) < 90


def test_what_missed_its_tolerance_is_said():
    undamped = hb.HillSystem(mass=1, stiffness={0: 1}, load={1: (1, None)})
    good = undamped.steady(omega=0.7)
    assert good.converged and good.shortfalls == []
    resonant = undamped.steady(omega=1.0)
    assert not resonant.converged and "no unique periodic solution" in resonant.shortfalls[0]
    stability = undamped.stability(omega=0.7)
    assert stability.converged and stability.shortfalls == []
