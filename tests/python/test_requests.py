"""Wrong arguments: RequestError names the argument, what was found and what is allowed."""

import math

import numpy as np
import pytest

import hb
from conftest import SCENES, command


@pytest.mark.parametrize(
    "arguments, field",
    [
        ({"rpm": -1}, "rpm"),
        ({"rpm": 0}, "rpm"),
        ({"rpm": float("nan")}, "rpm"),
        ({"rpm": float("inf")}, "rpm"),
        ({"rpm": "300"}, "rpm"),
        ({"rpm": [300]}, "rpm"),
        ({"rpm": np.zeros((2, 2))}, "rpm"),
        ({"rpm": True}, "rpm"),
        ({"rpm": 1j}, "rpm"),
        ({"rpm": 300, "omega": 3}, "omega"),
        ({"modes": 0}, "modes"),
        ({"modes": 61}, "modes"),
        ({"modes": 2.5}, "modes"),
        ({"modes": "many"}, "modes"),
        ({"modes": 10**30}, "modes"),
        ({"tol": 1}, "tol"),
        ({"tol": float("nan")}, "tol"),
        ({"rods": "XY"}, "rods"),
        ({"rods": ["AB", 3]}, "rods"),
        ({"rods": 3}, "rods"),
        ({"only": "everything"}, "only"),
        ({"theory": "quadratic"}, "theory"),
        ({"theory": 3}, "theory"),
        ({"period": 2}, "period"),
        ({"theory": "nonlinear", "period": 0}, "period"),
        ({"steady_method": "fast"}, "steady_method"),
        ({"stability_method": "fast"}, "stability_method"),
        ({"bound": "certain"}, "bound"),
    ],
)
def test_steady_refuses_by_name(six_link, arguments, field):
    with pytest.raises(hb.RequestError) as raised:
        six_link.steady(**{"rpm": 300, **arguments} if "omega" not in arguments else arguments)
    error = raised.value
    assert error.field == field
    assert error.found and error.allowed
    assert str(error).startswith(field + ": ")
    assert "--" not in str(error)


@pytest.mark.parametrize("only", ["growth", "verdict"])
def test_less_is_the_commands_less(six_link, only):
    path = SCENES / "six_link.toml"
    assert six_link.steady(rpm=300, modes=3, only=only).to_dict() == command(
        "steady", path, "--rpm", "300", "--modes", "3", "--only", only)
    sweep = six_link.sweep(rpm=(2000, 2400, 100), modes=2, only=only)
    assert sweep.to_dict() == command("sweep", path, "--rpm", "2000:2400:100", "--modes", "2", "--only", only)
    assert sweep["AB"].unstable_bands is None and sweep["AB"].not_excluded is None
    with pytest.raises(hb.RequestError) as raised:
        six_link.check(rpm=300, modes=1, only=only)
    assert raised.value.field == "only"


def test_what_is_not_looked_for_is_none_and_not_empty(six_link):
    path = SCENES / "six_link.toml"
    ranges = ["--rpm", "1400:1500:50", "--modes", "2"]
    points = six_link.sweep(rpm=(1400, 1500, 50), modes=2, search=False)
    assert points.to_dict() == command("sweep", path, *ranges, "--no-search")
    assert points["AB"].unstable_bands is None
    assert six_link.sweep(rpm=(1400, 1500, 50), modes=2)["AB"].not_excluded == []
    grid = dict(x="rpm=1000:1600:4", y="AB.J=40:60:3", modes=1)
    flags = ["--x", "rpm=1000:1600:4", "--y", "AB.J=40:60:3", "--modes", "1"]
    assert six_link.map(**grid, boundaries=False).to_dict() == command("map", path, *flags, "--no-boundaries")
    assert six_link.map(**grid, boundary_tol=1e-5).to_dict() == command("map", path, *flags, "--boundary-tol", "1e-5")
    for wrong in ({"boundaries": 1}, {"boundary_tol": 0.5}, {"only": "steady"}):
        with pytest.raises(hb.RequestError):
            six_link.map(**grid, **wrong)


def test_numbers_of_a_range_may_have_units(six_link):
    def lengths(x):
        return six_link.sweep(x=x, rpm=1500, modes=1, search=False).to_dict()

    assert lengths("AB.length=250mm:0.26m:5mm") == lengths("AB.length=250:260:5")
    grid = dict(y="AB.J=40:60:3", modes=1, boundaries=False)
    assert six_link.map(x="rpm=5Hz:10Hz:3", **grid).to_dict() == six_link.map(x="rpm=300:600:3", **grid).to_dict()
    with pytest.raises(hb.RequestError, match="a mass"):
        lengths("AB.length=250kg:260kg:x3")


def test_speeds_may_have_units(six_link):
    flags = {"modes": 1, "only": "stability"}
    plain = six_link.steady(rpm=300, **flags).to_dict()
    for speed in ({"rpm": "5 Hz"}, {"omega": "300 rpm"}, {"omega": 10 * math.pi}):
        found = six_link.steady(**speed, **flags)
        assert found.rpm == pytest.approx(300, rel=1e-15) and found.to_dict()["rods"].keys() == plain["rods"].keys()
    assert six_link.steady(rpm="5 Hz", **flags).to_dict() == plain
    values = six_link.sweep(rpm=(300, 600, 150), search=False, **flags).to_dict()
    for speeds in ("5Hz:10Hz:2.5Hz", ("5 Hz", "10 Hz", "2.5 Hz"), ("5 Hz", "10 Hz", "x3"), ["5 Hz", 450, "10 Hz"]):
        assert six_link.sweep(rpm=speeds, search=False, **flags).to_dict() == values
    assert six_link.check(rpm="5 Hz", modes=1).rpm == 300
    for wrong in ("5 kg", "5", ("5 Hz", 600, 150)):
        with pytest.raises(hb.RequestError) as raised:
            six_link.sweep(rpm=wrong, search=False, **flags)
        assert "rpm" in str(raised.value)
    system = hb.HillSystem(mass=1, damping=0.1, stiffness={0: 1.2, 1: 0.4}, load={1: 1.0})
    assert system.stability(omega="1 rad/s").growth_rate == system.stability(omega=1.0).growth_rate
    assert (system.steady(omega="1 rad/s").q == system.steady(omega=1.0).q).all()


@pytest.mark.parametrize("field", ["only", "rods"])
def test_an_empty_list_asks_for_nothing_and_is_refused(six_link, field):
    with pytest.raises(hb.RequestError) as raised:
        six_link.steady(rpm=300, **{field: []})
    assert raised.value.field == field and raised.value.found == "[]" and "None" in raised.value.allowed


def test_names_that_are_not_there_are_answered_with_those_that_are(steady):
    for mapping, known in ((steady, "CD"), (steady.joints, "AB.0")):
        with pytest.raises(KeyError, match="nope") as raised:
            mapping["nope"]
        assert known in str(raised.value)


def test_a_page_that_cannot_be_written_names_its_file(steady, tmp_path):
    with pytest.raises(OSError, match="none/page.html cannot be written") as raised:
        steady.report(tmp_path / "none" / "page.html")
    assert "--" not in str(raised.value)


def test_unknown_arguments_are_type_errors(six_link):
    with pytest.raises(TypeError):
        six_link.steady(speed=300)


@pytest.mark.parametrize("angle", [float("nan"), "x", [[1, 2]], None, [1, "2"], object()])
def test_wrong_angles_are_refused(steady, angle):
    for function in (steady["AB"].response, steady.joints["AB.0"].elastic, steady.torque.rigid):
        with pytest.raises(hb.RequestError) as raised:
            function(angle)
        assert raised.value.field == "angle"


@pytest.mark.parametrize("x", [-1, 260, float("nan"), "x", [[1]]])
def test_places_beyond_the_link_are_refused(steady, x):
    with pytest.raises(hb.RequestError) as raised:
        steady["AB"].deflection(x, 0)
    assert raised.value.field == "x"


def test_a_system_has_no_shape(mathieu):
    with pytest.raises(hb.RequestError):
        mathieu.steady(omega=1)["system"].deflection(0, 0)


def test_a_steady_state_that_was_not_computed_has_no_response(six_link):
    with pytest.raises(hb.RequestError):
        six_link.steady(rpm=300, only="stability")["AB"].response(0)


def test_a_speed_without_periodic_solution_is_told():
    resonant = hb.HillSystem(mass=1, stiffness={0: 4}, load={2: 1})
    rod = resonant.steady(omega=1)
    assert rod.error_bound is None
    with pytest.raises(hb.RequestError):
        rod.response(0)
