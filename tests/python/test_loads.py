"""Stress, safety, bearings, frame, drive: every key of the command's documents is an attribute with the same bits."""

import dataclasses
import math

import numpy
import pytest
from conftest import SCENES, command

import hb

STRENGTH = {"rod.yield": 350e6, "rod.tensile": 520e6, "rod.endurance": 200e6}
SETTING = [word for path, value in STRENGTH.items() for word in ("--set", f"{path}={value!r}")]


@pytest.fixture(scope="module")
def compressor():
    return hb.load(SCENES / "slider_crank_units.toml").with_(STRENGTH)


@pytest.fixture(scope="module")
def steady(compressor):
    return compressor.steady(rpm=3000)


@pytest.fixture(scope="module")
def sweep(compressor):
    return compressor.sweep(rpm=(1000, 3000, 1000))


def same(found, document):
    """An attribute beside the document's entry, to the last bit."""
    if dataclasses.is_dataclass(found):
        for key, value in document.items():
            same(getattr(found, key), value)
        known = {field.name for field in dataclasses.fields(found)}
        assert not set(document) - known
    elif isinstance(document, dict):
        assert set(found) == set(document)
        for key, value in document.items():
            same(found[key], value)
    elif isinstance(found, numpy.ndarray) and found.dtype.kind in "fc":
        flat = [complex(*v) if found.dtype.kind == "c" else math.nan if v is None else v for v in document]
        numpy.testing.assert_array_equal(found, numpy.array(flat))
        assert not found.flags.writeable
    elif isinstance(found, numpy.ndarray):
        assert list(found) == document
    else:
        assert found == document


# Keys whose attribute has another name or is found elsewhere.
ELSEWHERE_IN_ROD = {
    "deflection": lambda rod: rod.deflection_peak,
    "bending_moment": lambda rod: rod.bending_moment_peak,
    "growth_interval": lambda rod: list(rod.stability.growth_interval),
    "exponent_error": lambda rod: rod.growth_error,
    "stability_method": lambda rod: rod.stability.method,
    "stability_converged": lambda rod: rod.stability.converged,
}


def test_every_key_of_a_rod_is_an_attribute(steady):
    document = command("steady", SCENES / "slider_crank_units.toml", "--rpm", 3000, *SETTING)["rods"]["rod"]
    rod = steady["rod"]
    for key, value in document.items():
        if key == "q":
            assert list(rod.max_abs) == value["max_abs"]
            assert list(rod.crank_angle) == value["crank_angle"]
        elif key in ELSEWHERE_IN_ROD:
            same(ELSEWHERE_IN_ROD[key](rod), value)
        else:
            assert hasattr(rod, key), key
            same(getattr(rod, key), value)
    assert rod.stress.yield_safety == 350e6 / rod.stress.max_abs
    assert rod.stress.fatigue_line == "Goodman"


def test_every_key_of_one_speed_is_an_attribute(steady):
    document = command("steady", SCENES / "slider_crank_units.toml", "--rpm", 3000, *SETTING)
    for key, value in document.items():
        assert hasattr(steady, key), key
        if key in ("rods", "torque", "joints"):
            continue
        same(getattr(steady, key), value)
    for key in ("min", "max", "mean", "rms"):
        assert getattr(steady.torque, key) == document["torque"][key]
        assert getattr(steady.torque, f"{key}_rigid") == document["torque"]["rigid"][key]
    assert steady.torque.mean_theory_error == steady.to_dict()["torque"]["mean_theory_error"]
    assert steady.power.mean_theory_error == steady.to_dict()["power"]["mean_theory_error"]
    assert steady.torque.error == pytest.approx(document["torque"]["error"], rel=1e-12)
    assert 0 < steady.joints["rod.0"].error <= document["bearings"]["rod.0"]["error"]
    for name, components in document["joints"].items():
        joint = steady.joints[name]
        if "n" in components:
            assert (joint.min, joint.max) == (components["n"]["min"], components["n"]["max"])
            assert joint.max_rigid == components["n_rigid"]["max"]
        else:
            assert list(joint.min) == [components["x"]["min"], components["y"]["min"]]
            assert list(joint.max_rigid) == [components["x_rigid"]["max"], components["y_rigid"]["max"]]
    assert steady.bearings["rod.0"].max >= abs(steady.joints["rod.0"].max).max()


def test_modes_of_a_motion_have_frequencies_and_damping_ratios(compressor):
    setting = dict(rpm=1000, modes=2, theory="nonlinear")
    found = compressor.steady(**setting).system
    document = command(
        "steady", SCENES / "slider_crank_units.toml", "--rpm", 1000, "--modes", 2, "--theory", "nonlinear"
    )["system"]
    for key in ("frequencies_hz", "frequencies_hz_errors", "damping_ratios", "damping_ratio_errors"):
        assert list(getattr(found, key)) == pytest.approx(document[key], rel=1e-12), key


def test_what_was_not_asked_is_none_or_empty(compressor):
    little = compressor.steady(rpm=3000, only="stability")
    assert little.bearings == {} and little.sliders == {}
    assert little.frame is None and little.power is None and little.flywheel is None and little.joints_error is None
    rod = little["rod"]
    assert rod.stress is None and rod.static_deflection is None and rod.deflection_peak is None and rod.status is None


def test_every_key_along_the_speed_is_an_attribute(sweep):
    document = command("sweep", SCENES / "slider_crank_units.toml", "--rpm", "1000:3000:1000", *SETTING)
    for key, value in document.items():
        if key == "x":
            assert list(sweep.x) == value["values"]
        elif key not in ("rods", "status"):
            assert hasattr(sweep, key), key
            same(getattr(sweep, key), value)
    rod = sweep["rod"]
    for key, value in document["rods"]["rod"].items():
        assert hasattr(rod, key), key
        if key not in ("max_abs", "exponents"):
            same(getattr(rod, key), value)
    assert (numpy.diff(rod.stress.yield_safety) < 0).all()
    assert sweep.bearings["rod.0"].max.shape == (3,)
    assert sweep.bearings["rod.0"].mean is None


def test_a_motion_without_linearisation_has_its_keys(compressor):
    s = compressor.steady(rpm=1000, theory="nonlinear")
    document = s.to_dict()
    for key, value in document.items():
        assert hasattr(s, key), key
        if key not in ("rods", "torque", "joints", "system", "theory"):
            same(getattr(s, key), value)
    assert s.theory == "nonlinear" and s.period == 1 and s.found
    same(s["rod"].stress, document["rods"]["rod"]["stress"])
    linear = compressor.steady(rpm=1000)
    for name in ("max_abs", "mean", "amplitude", "yield_safety"):
        assert getattr(s["rod"].stress, name) == pytest.approx(getattr(linear["rod"].stress, name), rel=0.02)
    assert s["rod"].stress.yield_safety == pytest.approx(350e6 / s["rod"].stress.max_abs)
    assert s.frame.max == pytest.approx(linear.frame.max, rel=0.01) and s.frame.force_error < 1e-3 * s.frame.max
    assert s.sliders["piston"].position.max == pytest.approx(linear.sliders["piston"].position.max, rel=1e-3)


def test_check_has_every_key(compressor):
    c = compressor.check(rpm=1500, modes=1)
    document = c.to_dict()
    for key in document:
        assert hasattr(c, key), key
    for key, value in document["rods"]["rod"].items():
        assert hasattr(c["rod"], key), key
        same(getattr(c["rod"], key), value)
    assert c.verdict == "stable"


def test_tune_has_every_key(compressor):
    t = compressor.tune(minimise="mass", vary={"rod.section.flange": (3e-3, 5e-3)}, keep=["stable>=5"], over=(1000, 1500), analyses=6)
    document = t.to_dict()
    for key, value in document.items():
        if key != "minimise":
            assert hasattr(t, key), key
            if key not in ("status", "shortfall"):
                same(getattr(t, key), value)
    assert t.verdict == "stable" and t.verdict_before == "stable"


def test_strengths_that_cannot_be_name_key_and_bound(compressor):
    with pytest.raises(hb.SceneError, match="tensile strength") as refused:
        compressor.with_({"rod.yield": 600e6})
    assert "yield" in str(refused.value)


def test_bands_are_the_commands(compressor):
    s = compressor.steady(rpm=3000, band={"damping": (0.5, 2)})
    document = command("steady", SCENES / "slider_crank_units.toml", "--rpm", 3000, *SETTING, "--band", "damping=0.5:2")
    assert s.bands == document["bands"] and s.to_dict() == document
    assert s.bands[0]["verdict_to"] == "stable"
    with pytest.raises(hb.RequestError, match="band"):
        compressor.steady(rpm=3000, band="damping=2:0.5")
    motion = compressor.steady(rpm=1000, modes=1, theory="nonlinear", band="E=0.9:1.1")
    document = command(
        "steady", SCENES / "slider_crank_units.toml", "--rpm", 1000, *SETTING, "--modes", 1, "--theory", "nonlinear",
        "--band", "E=0.9:1.1",
    )
    assert motion.bands == document["bands"] and motion.bands[0]["verdict_from"] == "stable"
    assert "E of the elastic links times 0.9 to 1.1" in str(motion)
    with pytest.raises(hb.RequestError, match="band"):
        compressor.sweep(rpm=(1000, 2000, 500), theory="nonlinear", band="E=0.9:1.1")


def test_bands_of_a_sweep_are_the_commands(compressor):
    sw = compressor.sweep(rpm=(1000, 2000, 500), search=False, band={"E": (0.9, 1.1)})
    document = command(
        "sweep", SCENES / "slider_crank_units.toml", "--rpm", "1000:2000:500", *SETTING, "--no-search", "--band", "E=0.9:1.1"
    )
    assert sw.bands == document["bands"] and sw.to_dict() == document
    along = compressor.sweep(rpm=1000, x="piston.mass=0.4:0.5:0.1", search=False, band="E=0.9:1.1")
    one = compressor.with_({"piston.mass": 0.5}).steady(rpm=1000, band="E=0.9:1.1")
    stress = next(q for q in one.bands[0]["quantities"] if q["name"] == "stress, together")
    found = along.bands[0]["at_to"]["rods"]["rod"]["stress"]["max_abs"][-1]
    assert found == pytest.approx(1e6 * stress["to"], rel=1e-6)


def test_stresses_of_a_map_are_arrays(compressor):
    strong = compressor.with_(STRENGTH)
    mp = strong.map(x="rpm=1000:3000:3", y="piston.mass=0.3:0.5:2", boundaries=False, stress=True)
    s = strong.with_({"piston.mass": 0.5}).steady(rpm=2000)["rod"]
    rod = mp["rod"]
    assert rod.stress.max_abs.shape == rod.deflection.shape == rod.theory_error.shape == (2, 3)
    assert rod.stress.fatigue_safety[1, 1] == pytest.approx(s.stress.fatigue_safety, rel=1e-6)
    assert rod.stress.error[1, 1] < 0.05 * rod.stress.max_abs[1, 1]
    assert compressor.map(x="rpm=1000:3000:3", y="piston.mass=0.3:0.5:2", boundaries=False)["rod"].stress is None


def test_a_design_keeps_a_safety(compressor):
    t = compressor.with_(STRENGTH).tune(
        minimise="mass", vary={"rod.section.height": (0.01, 0.03)}, keep=["safety>=2"], over=(1000, 2000), speeds=4, analyses=30
    )
    assert t.conditions[0]["value"] >= 2 * (1 - 1e-6)
    assert t.metrics[1]["after"]["against"] in ("yielding", "fatigue (Goodman)")


def test_damping_comes_back_from_a_decay_and_a_peak():
    t = numpy.linspace(0, 0.3, 400)
    fit = hb.fit_decay(t, numpy.exp(-0.01 * 500 * t) * numpy.cos(500 * math.sqrt(1 - 1e-4) * t))
    assert fit.ratio == pytest.approx(0.01, rel=1e-4) and fit.frequency == pytest.approx(500, rel=1e-6)
    assert fit.fitted.shape == t.shape and fit.residual < 1e-4
    omega = numpy.linspace(450, 550, 51)
    peak = hb.fit_peak(omega, 1 / numpy.hypot(500**2 - omega**2, 2 * 0.02 * 500 * omega))
    assert peak.ratio == pytest.approx(0.02, rel=1e-4)
    with pytest.raises(hb.RequestError):
        hb.fit_peak(omega, omega)
    with pytest.raises(hb.RequestError):
        hb.fit_decay(t, t[:-1])
