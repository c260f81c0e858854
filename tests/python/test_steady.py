"""One speed: the command's numbers to the last bit, and objects that show them."""

import gc
import pickle
import weakref

import numpy as np
import pytest
from conftest import SCENES, command

import hb


@pytest.mark.parametrize(
    "scene, arguments, flags",
    [
        ("six_link.toml", {"rpm": 300}, ["--rpm", "300"]),
        ("six_link.toml", {"rpm": 1234.5, "modes": 3, "tol": 1e-8}, ["--rpm", "1234.5", "--modes", "3", "--tol", "1e-8"]),
        ("six_link.toml", {"rpm": 300, "rods": ["CD"]}, ["--rpm", "300", "--rods", "CD"]),
        ("six_link.toml", {"rpm": 300, "only": "steady,shape"}, ["--rpm", "300", "--only", "steady,shape"]),
        ("six_link.toml", {"rpm": 300, "only": ["verdict"]}, ["--rpm", "300", "--only", "verdict"]),
        ("six_link.toml", {"omega": 40.0, "modes": "auto"}, ["--omega", "40", "--modes", "auto"]),
        ("slider_crank.toml", {}, []),
        ("mathieu.toml", {"omega": 2.1, "bound": "proved"}, ["--omega", "2.1", "--bound", "proved"]),
        ("sampled_stiffness.toml", {"omega": 1.5}, ["--omega", "1.5"]),
        ("two_oscillators.toml", {"omega": 0.7, "steady_method": "direct"}, ["--omega", "0.7", "--steady-method", "direct"]),
        (
            "four_bar.toml",
            {"rpm": 200, "modes": 1, "theory": "nonlinear"},
            ["--rpm", "200", "--modes", "1", "--theory", "nonlinear"],
        ),
    ],
)
def test_the_document_is_the_commands(scene, arguments, flags):
    assert hb.load(SCENES / scene).steady(**arguments).to_dict() == command("steady", SCENES / scene, *flags)


def test_arrays_hold_the_documents_numbers(steady):
    document = steady.to_dict()
    for name, entry in document["rods"].items():
        rod = steady[name]
        assert rod.name == name
        assert rod.modes == entry["modes"] and rod.harmonics == entry["harmonics"]
        assert [[[c.real, c.imag] for c in row] for row in rod.q] == entry["q"]["fourier"]
        assert rod.max_abs.tolist() == entry["q"]["max_abs"]
        assert rod.crank_angle.tolist() == entry["q"]["crank_angle"]
        assert [[e.real, e.imag] for e in rod.exponents] == entry["exponents"]
        assert rod.exponent_errors.tolist() == entry["exponent_errors"]
        for attribute, key in [
            ("error_bound", "error_bound"),
            ("modes_error", "modes_error"),
            ("growth_modes", "growth_modes"),
            ("theory_error", "theory_error"),
            ("growth_rate", "growth_rate"),
            ("growth_error", "exponent_error"),
            ("verdict", "verdict"),
        ]:
            assert getattr(rod, attribute) == entry[key], attribute
        assert list(rod.stability.growth_interval) == entry["growth_interval"]
        assert rod.to_dict() == entry
    assert steady.verdict == document["verdict"]
    assert steady.rpm == document["rpm"] and steady.omega == document["omega"]
    assert steady.converged is True and steady.shortfalls == []


def test_a_shortfall_is_told(six_link):
    result = six_link.steady(rpm=300, modes="auto", tol=1e-13, only="steady", rods="AB")
    document = result.to_dict()
    assert document["status"] != "reached"
    assert result.converged is False
    assert result.shortfalls == document["notes"]


def test_arrays_are_views_without_copies(steady):
    rod = steady["AB"]
    for name in ("q", "max_abs", "exponents", "exponent_errors"):
        array = getattr(rod, name)
        assert not array.flags.writeable and not array.flags.owndata, name
        assert array.__array_interface__["data"] == getattr(rod, name).__array_interface__["data"], name
        with pytest.raises(ValueError):
            array[0] = 1


def test_arrays_outlive_everything_else():
    def q():
        return hb.load(SCENES / "six_link.toml").steady(rpm=300, only="steady")["AB"].q

    array = q()
    gc.collect()
    again = q()
    assert (array == again).all()


def test_results_go_when_they_are_let_go(six_link):
    result = six_link.steady(rpm=300, modes=1, only="steady")
    rod = result["AB"]
    gone = weakref.ref(result)
    del result
    gc.collect()
    assert gone() is None
    assert rod.q.shape[0] == 1


def test_response_is_the_series_at_the_angles(steady):
    rod = steady["AB"]
    angle = np.linspace(0, 2 * np.pi, 17)
    n = np.arange(rod.q.shape[1])
    weight = np.where(n == 0, 1, 2)
    expected = (rod.q * weight) @ np.exp(1j * np.outer(n, angle))
    found = rod.response(angle)
    assert found.shape == (5, 17)
    assert np.abs(found - expected.real).max() <= 1e-13 * rod.max_abs.max()
    assert rod.response(0.3).shape == (5,)
    at_peak = rod.response(rod.crank_angle)
    assert np.abs(np.abs(np.diag(at_peak)) - rod.max_abs).max() <= 1e-12 * rod.max_abs.max()


def test_deflection_and_moment_have_the_documents_peaks(steady):
    for name, entry in steady.to_dict()["rods"].items():
        for what in ("deflection", "bending_moment"):
            peak = entry[what]
            found = getattr(steady[name], what)(peak["x"], peak["crank_angle"])
            assert abs(abs(found) - peak["max_abs"]) <= 1e-10 * peak["max_abs"]
    assert steady["AB"].deflection([0, 100, 259], [0, 1, 2, 3]).shape == (3, 4)


def test_angles_are_in_the_scenes_unit(slider_crank):
    result = slider_crank.steady()
    rod = result["rod"]
    assert np.abs(np.abs(np.diag(rod.response(rod.crank_angle))) - rod.max_abs).max() <= 1e-12 * rod.max_abs.max()
    assert rod.response(0.0) == pytest.approx(rod.response(360.0), rel=1e-9)


def test_forces_are_functions_of_the_crank_angle(slider_crank):
    result = slider_crank.steady()
    document = result.to_dict()
    angle = np.linspace(0, 360, 20001)
    assert set(result.joints) == set(document["joints"])
    for name, entry in document["joints"].items():
        elastic, rigid = result.joints[name].elastic(angle), result.joints[name].rigid(angle)
        if "n" in entry:
            assert elastic.shape == rigid.shape == angle.shape
            pairs = [("n", elastic), ("n_rigid", rigid)]
        else:
            assert elastic.shape == rigid.shape == (2, len(angle))
            pairs = [("x", elastic[0]), ("y", elastic[1]), ("x_rigid", rigid[0]), ("y_rigid", rigid[1])]
        for key, values in pairs:
            size = max(abs(entry[key]["min"]), abs(entry[key]["max"]))
            assert values.min() == pytest.approx(entry[key]["min"], abs=1e-4 * size)
            assert values.max() == pytest.approx(entry[key]["max"], abs=1e-4 * size)
    torque = result.torque.elastic(angle)
    assert torque.shape == angle.shape
    assert torque.max() == pytest.approx(document["torque"]["max"], rel=1e-4)


def test_what_was_not_computed_is_none(six_link):
    rod = six_link.steady(rpm=300, only="stability")["AB"]
    assert rod.q is None and rod.max_abs is None and rod.error_bound is None and rod.harmonics is None
    rod = six_link.steady(rpm=300, only="steady")["AB"]
    assert rod.verdict is None and rod.exponents is None and rod.growth_rate is None
    result = six_link.steady(rpm=300, only="steady")
    assert dict(result.joints) == {} and result.torque is None and result.verdict is None


def test_the_theory_error_of_the_growth_rate_is_what_the_motion_changes(six_link):
    scene = hb.load(SCENES / "six_link.toml")
    linear, motion = (scene.steady(rpm=900, modes=2, theory=theory) for theory in ("linear", "nonlinear"))
    rates = [linear[name].growth_rate for name in linear]
    change = abs(motion.system.growth_rate - max(rates))
    assert abs(linear.growth_theory_error - change) < 0.1 * change
    assert linear.growth_theory_error == linear.to_dict()["growth_theory_error"]


def test_a_motion_without_linearisation_has_one_stability(six_link):
    result = hb.load(SCENES / "four_bar.toml").steady(rpm=200, modes=1, theory="nonlinear")
    document = result.to_dict()
    name = next(iter(result))
    assert result.verdict == document["verdict"] == result.system.verdict
    assert [[e.real, e.imag] for e in result.system.exponents] == document["system"]["exponents"]
    assert [[[c.real, c.imag] for c in row] for row in result[name].q] == document["rods"][name]["q"]["fourier"]


def test_pickles_have_the_same_bits():
    result = hb.load(SCENES / "four_bar.toml").steady(rpm=600, modes=2)
    again = pickle.loads(pickle.dumps(result))
    assert again.to_dict() == result.to_dict()
    rod = pickle.loads(pickle.dumps(next(iter(result.rods.values()))))
    assert (rod.q == result[rod.name].q).all()


def test_unknown_links_are_told_with_those_there_are(steady):
    with pytest.raises(KeyError, match="AB, CD"):
        steady["ab"]
    assert "AB" in steady and list(steady) == ["AB", "CD"] and len(steady) == 2
