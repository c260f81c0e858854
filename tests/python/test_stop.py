"""Ctrl-C and a time limit end work of any kind, wherever it is."""

import signal
import threading
import time

import pytest

import hb
from conftest import SCENES

# A turn that passes near a dead centre: tens of seconds for one speed.
HARD = {"rpm": 3000, "modes": "auto", "tol": 1e-13}


@pytest.fixture(scope="module")
def near_dead_centre():
    return hb.load(SCENES / "slider_crank.toml").with_({"crank.length": 144.9})


def interrupted(call, after=0.5):
    """Seconds from Ctrl-C until the call has ended."""
    sent = []

    def interrupt():
        sent.append(time.monotonic())
        signal.raise_signal(signal.SIGINT)

    timer = threading.Timer(after, interrupt)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        call()
    seconds = time.monotonic() - sent[0]
    timer.join()
    return seconds


SOON = 20  # seconds: what is asked is one, on a machine with nothing else to do


def test_ctrl_c_ends_one_speed(near_dead_centre):
    assert interrupted(lambda: near_dead_centre.steady(**HARD)) < SOON


def test_ctrl_c_ends_a_point_of_a_sweep_on_another_thread(near_dead_centre):
    call = {**HARD, "rpm": (3000, 3001, "x2"), "modes": 40, "threads": 2}
    assert interrupted(lambda: near_dead_centre.sweep(**call)) < SOON


def test_ctrl_c_ends_one_comparison(near_dead_centre):
    assert interrupted(lambda: near_dead_centre.check(rpm=3000, modes=30, tol=1e-12, case_limit=600)) < SOON


def test_ctrl_c_ends_exponents():
    m = hb.load(SCENES / "six_link.toml")
    assert interrupted(lambda: [m.steady(rpm=300 + k / 8, modes=60, only="stability") for k in range(10000)]) < SOON


def test_ctrl_c_ends_a_bench():
    assert interrupted(lambda: hb.load(SCENES / "six_link.toml").bench(rpm=1500, case_limit=100)) < SOON


def test_an_answer_after_an_interrupted_one_is_the_same(near_dead_centre, six_link):
    expected = six_link.steady(rpm=300).to_dict()
    interrupted(lambda: near_dead_centre.steady(**HARD))
    assert six_link.steady(rpm=300).to_dict() == expected


def test_one_speed_that_is_not_there_in_time_is_a_timeout(near_dead_centre):
    with pytest.raises(TimeoutError, match="0.3 s"):
        near_dead_centre.steady(**HARD, time_limit=0.3)


def test_a_sweep_gives_what_is_there_in_time():
    sweep = hb.load(SCENES / "four_bar.toml").sweep(rpm=(200, 60000, 0.5), time_limit=0.5)
    assert not sweep.converged and "ended before the answer was complete" in sweep.shortfalls[0]
    assert len(sweep) == 119601
    assert sweep.to_dict()["status"] == "tolerance not reached"


def test_a_map_gives_what_is_there_in_time():
    found = hb.load(SCENES / "six_link.toml").map(x="rpm=200:6000:400", y="*.J=20:200:400", time_limit=1.5)
    assert not found.converged and "ended before the answer was complete" in found.shortfalls[0]


def test_a_check_gives_the_speeds_that_are_there_in_time():
    found = hb.load(SCENES / "four_bar.toml").check(rpm=(200, 600, "x500"), modes=1, time_limit=2)
    assert not found.converged and any("speeds were not computed" in s for s in found.shortfalls)
    try:
        assert not hb.load(SCENES / "four_bar.toml").check(rpm=(200, 600, "x500"), time_limit=1e-3).converged
    except TimeoutError as error:  # not even one speed was ready
        assert "0.001 s" in str(error)


def test_a_motion_without_linearisation_is_given_up_in_time(six_link):
    found = six_link.steady(rpm=1500, modes=5, theory="nonlinear", time_limit=0.01)
    assert not found.converged and any("time_limit=0.01" in s for s in found.shortfalls)


def test_a_design_that_is_not_there_in_time_is_a_timeout_and_time_enough_changes_nothing(six_link_design):
    scene, arguments = six_link_design
    with pytest.raises(TimeoutError):
        scene.tune(**arguments, time_limit=1e-3)
    assert scene.tune(**arguments, time_limit=1e6).values == scene.tune(**arguments).values


@pytest.fixture
def six_link_design():
    return hb.load(SCENES / "six_link.toml"), {
        "minimise": "deflection",
        "vary": {"AB.J": (20, 200), "CD.J": (20, 200)},
        "keep": ["stable"],
        "over": (300, 1200),
        "modes": 1,
        "analyses": 6,
    }


@pytest.mark.parametrize("limit", [0, -1, float("nan"), float("inf"), "soon", True])
def test_time_limits_that_are_none_are_refused(six_link, limit):
    for ask in (six_link.steady, six_link.sweep, six_link.check):
        with pytest.raises(hb.RequestError) as raised:
            ask(rpm=300, time_limit=limit)
        assert raised.value.field in ("time_limit", "rpm")
