"""Sweeps, maps, checks and designs: the command's documents, whatever the number of threads; ended by Ctrl-C."""

import pickle
import signal
import threading
import time

import numpy as np
import pytest
from conftest import SCENES, command

import hb

FOUR_BAR = SCENES / "four_bar.toml"
MATHIEU = SCENES / "mathieu.toml"


@pytest.fixture(scope="module")
def four_bar():
    return hb.load(FOUR_BAR)


@pytest.fixture(scope="module")
def sweep(four_bar):
    return four_bar.sweep(rpm=(300, 900, 50), modes=2)


@pytest.mark.parametrize(
    "scene, arguments, flags",
    [
        ("four_bar.toml", {"rpm": (300, 900, 50), "modes": 2}, ["--rpm", "300:900:50", "--modes", "2"]),
        ("four_bar.toml", {"rpm": "300:900:x5", "only": "stability"}, ["--rpm", "300:900:x5", "--only", "stability"]),
        ("mathieu.toml", {"omega": (1.9, 2.5, 0.1)}, ["--omega", "1.9:2.5:0.1"]),
        (
            "mathieu.toml",
            {"x": "hill.damping.0.0=0.05:0.2:x4", "omega": 2.1},
            ["--x", "hill.damping.0.0=0.05:0.2:x4", "--omega", "2.1"],
        ),
        (
            "four_bar.toml",
            {"rpm": (200, 400, 100), "modes": 1, "theory": "nonlinear"},
            ["--rpm", "200:400:100", "--modes", "1", "--theory", "nonlinear"],
        ),
        ("slider_crank.toml", {"rpm": (1000, 3000, "x3"), "modes": 2}, ["--rpm", "1000:3000:x3", "--modes", "2"]),
    ],
)
def test_a_sweep_is_the_commands(scene, arguments, flags):
    file = SCENES / scene
    assert hb.load(file).sweep(**arguments).to_dict() == command("sweep", file, *flags)


def test_values_may_be_an_array(four_bar, sweep):
    assert four_bar.sweep(rpm=np.arange(300.0, 901.0, 50.0), modes=2).to_dict() == sweep.to_dict()


def test_threads_leave_the_bits_alone(four_bar, sweep):
    assert four_bar.sweep(rpm=(300, 900, 50), modes=2, threads=2).to_dict() == sweep.to_dict()
    x, y = "rpm=200:800:3", "*.damping_internal=1e-4:1e-3:3"
    maps = [four_bar.map(x=x, y=y, modes=2, threads=threads).to_dict() for threads in (1, 2)]
    assert maps[0] == maps[1]


def test_several_threads_may_ask_at_once(six_link):
    expected = six_link.steady(rpm=300, modes=2).to_dict()
    found = []
    threads = [threading.Thread(target=lambda: found.append(six_link.steady(rpm=300, modes=2).to_dict())) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 4


def test_a_sweeps_arrays_hold_the_documents_numbers():
    sweep = hb.load(MATHIEU).sweep(omega=(1.9, 2.5, 0.1))
    document = sweep.to_dict()
    entry, rod = document["rods"]["system"], sweep["system"]
    assert sweep.x.tolist() == document["x"]["values"] and sweep.rpm.tolist() == document["rpm"]
    assert rod.max_abs.tolist() == entry["max_abs"]
    assert rod.growth_rate.tolist() == entry["growth_rate"] and rod.verdict.tolist() == entry["verdict"]
    assert [[[e.real, e.imag] for e in row if not np.isnan(e)] for row in rod.exponents] == entry["exponents"]
    assert rod.unstable_bands == document["unstable_bands"]["system"] and len(rod.unstable_bands) == 1
    assert sweep.critical == document["critical"]
    assert sweep.critical_x.tolist() == document["critical_x"]
    assert sweep.verdict.tolist() == document["verdict"]
    assert not rod.max_abs.flags.writeable
    assert np.isnan(rod.theory_error).all()


def test_branches_stand_beside_the_linear_sweep():
    sweep = hb.load(FOUR_BAR).sweep(rpm=(200, 400, 100), modes=1, theory="nonlinear")
    document = sweep.to_dict()
    assert sweep.branches == document["branches"] and len(sweep.branches) >= 1
    assert sweep.folds.tolist() == document["folds"] and sweep.bifurcations == document["bifurcations"]
    pyplot = pytest.importorskip("matplotlib.pyplot")
    assert sweep.plot("branches").get_title(loc="left")
    pyplot.close("all")


def test_places_without_a_linkage_are_nan():
    scene = hb.load(FOUR_BAR)
    longest = scene["crank.length"]
    sweep = scene.sweep(x=("crank.length", (longest, 6 * longest, "x4")), rpm=300, modes=1, only="steady")
    rod = next(iter(sweep.rods.values()))
    assert np.isfinite(rod.max_abs[0]).all() and np.isnan(rod.max_abs[-1]).all()


@pytest.mark.parametrize(
    "scene, arguments, flags",
    [
        (
            "four_bar.toml",
            {"x": "rpm=200:800:3", "y": "*.damping_internal=1e-4:1e-3:3", "modes": 2},
            ["--x", "rpm=200:800:3", "--y", "*.damping_internal=1e-4:1e-3:3", "--modes", "2"],
        ),
        (
            "mathieu.toml",
            {"x": ("omega", (1.9, 2.5, 7)), "y": ("hill.stiffness.1.cos.0.0", (0.1, 0.5, 5))},
            ["--x", "omega=1.9:2.5:7", "--y", "hill.stiffness.1.cos.0.0=0.1:0.5:5"],
        ),
        (
            "slider_crank.toml",
            {"x": "rpm=500:600:2", "y": "rod.J=800:900:x2"},
            ["--x", "rpm=500:600:2", "--y", "rod.J=800:900:x2"],
        ),
    ],
)
def test_a_map_is_the_commands(scene, arguments, flags):
    file = SCENES / scene
    found = hb.load(file).map(**arguments)
    document = command("map", file, *flags)
    assert found.to_dict() == document
    assert found.growth_rate.tolist() == document["growth_rate"]
    assert found.verdict.tolist() == document["verdict"]
    assert found.growth_rate.shape == (len(found.y), len(found.x))
    for curve, entry in zip(found.boundaries, document["boundaries"], strict=True):
        assert curve.points.tolist() == entry["points"] and curve.kind == entry["kind"]


def without_seconds(document):
    if isinstance(document, dict):
        return {k: without_seconds(v) for k, v in document.items() if "seconds" not in k}
    return document


@pytest.mark.parametrize(
    "scene, arguments, flags",
    [
        ("slider_crank.toml", {"rpm": 1500, "modes": 1, "integrator": "adams"}, ["--rpm", "1500", "--modes", "1", "--integrator", "adams"]),
        ("mathieu.toml", {"omega": (1.0, 2.0, 0.5), "integrator": "bdf"}, ["--omega", "1:2:0.5", "--integrator", "bdf"]),
        (
            "four_bar.toml",
            {"rpm": 200, "modes": 1, "theory": "nonlinear", "integrator": "adams"},
            ["--rpm", "200", "--modes", "1", "--theory", "nonlinear", "--integrator", "adams"],
        ),
        (
            "mathieu.toml",
            {"omega": 2.1, "integrator": "collocation"},
            ["--omega", "2.1", "--integrator", "collocation"],
        ),
    ],
)
def test_a_check_is_the_commands(scene, arguments, flags):
    file = SCENES / scene
    found = hb.load(file).check(**arguments)
    document = command("check", file, *flags)
    assert without_seconds(found.to_dict()) == without_seconds(document)
    assert found.agrees is True
    name = next(iter(found))
    assert found[name].q_difference == document["rods"][name]["q_difference"]
    assert found.seconds["shooting"] > 0


def test_a_map_has_boundaries_over_a_range_of_damping(mathieu):
    arguments = {"x": "omega=1.9:2.5:7", "y": "hill.stiffness.1.cos.0.0=0.1:0.5:5"}
    flags = ["--x", arguments["x"], "--y", arguments["y"], "--damping-range", "0.5:2"]
    found = mathieu.map(**arguments, damping_range=(0.5, 2))
    assert found.to_dict() == command("map", MATHIEU, *flags)
    assert sorted(found.damping) == [0.5, 2.0]
    assert len(found.damping[0.5]) >= 1 and found.damping[0.5][0].points.shape[1] == 2
    again = pickle.loads(pickle.dumps(found))
    assert str(again) == str(found)


def test_a_map_has_boundaries_over_a_band_of_youngs_modulus():
    file = SCENES / "six_link.toml"
    arguments = {"x": "rpm=1400:2200:5", "y": "*.J=30:60:3", "modes": 1}
    flags = ["--x", arguments["x"], "--y", arguments["y"], "--modes", "1", "--band", "E=0.9:1.1"]
    found = hb.load(file).map(**arguments, band={"E": (0.9, 1.1)})
    assert found.to_dict() == command("map", file, *flags)
    assert sorted(found.band) == [0.9, 1.1] and found.damping == {}
    assert len(found.band[0.9]) >= 1
    with pytest.raises(hb.RequestError) as raised:
        hb.load(file).map(**arguments, band={"E": (0.9, 1.1), "mass": (0.9, 1.1)})
    assert raised.value.field == "band"


@pytest.mark.parametrize(
    "factors", [(2, 0.5), (-1, 2), (1, float("nan")), (1, float("inf")), (1,), (1, 2, 3), "0.5:2", {"low": 1}, 3]
)
def test_factors_on_the_damping_are_checked(mathieu, factors):
    with pytest.raises(hb.RequestError) as raised:
        mathieu.map(x="omega=1.9:2.5:3", y="hill.stiffness.1.cos.0.0=0.1:0.5:3", damping_range=factors)
    assert raised.value.field == "damping_range" and raised.value.found and raised.value.allowed


def test_damping_that_is_an_axis_or_not_there_is_not_multiplied(mathieu, six_link):
    with pytest.raises(hb.RequestError, match="other than the damping"):
        mathieu.map(x="omega=1.9:2.5:3", y="hill.damping.0.0=0.1:0.5:3", damping_range=(0.5, 2))
    with pytest.raises(hb.RequestError, match="without boundaries"):
        mathieu.map(
            x="omega=1.9:2.5:3", y="hill.stiffness.1.cos.0.0=0.1:0.5:3", damping_range=(0.5, 2), boundaries=False
        )


def test_a_map_without_boundaries_reached_what_was_asked(mathieu):
    found = mathieu.map(x="omega=1.9:2.5:3", y="hill.stiffness.1.cos.0.0=0.1:0.5:3", boundaries=False)
    assert found.converged and found.boundaries == [] and found.shortfalls == []


def timeless(document):
    if isinstance(document, dict):
        return {k: timeless(v) for k, v in document.items() if not any(w in k for w in ("seconds", "memory", "ratios"))}
    if isinstance(document, list):
        return [timeless(entry) for entry in document]
    return document


def test_a_bench_is_the_commands():
    told = []
    found = hb.load(MATHIEU).bench(omega=1.0, case_limit=1, progress=lambda *a: told.append(a))
    document = command("bench", MATHIEU, "--omega", "1", "--case-limit", "1")
    ours, theirs = timeless(found.to_dict()), timeless(document)
    for one in (ours, theirs):  # what the limit of time left out
        one["rods"]["system"].pop("left_out")
        one["rods"]["system"]["rows"] = [row for row in one["rods"]["system"]["rows"] if "harmonic" in row["method"]]
    assert ours == theirs
    rod = found["system"]
    assert found.converged and list(found) == ["system"] and rod.verdict == "stable"
    assert len(rod.rows) > 20 and all(row["seconds"] > 0 for row in rod.rows) and len(rod.ratios) == 4
    assert told and all(done <= total for _, done, total in told)
    assert "error against run time" in str(found)
    again = pickle.loads(pickle.dumps(found))
    assert again.to_dict() == found.to_dict() and str(again) == str(found)
    pytest.importorskip("pandas")
    assert len(found.to_frame()) == len(rod.rows)
    pyplot = pytest.importorskip("matplotlib.pyplot")
    assert "error against run time" in found.plot().get_title(loc="left")
    pyplot.close("all")


def test_a_bench_knows_the_motion_without_linearisation():
    found = hb.load(FOUR_BAR).bench(rpm=300, modes=1, case_limit=1, theory="nonlinear")
    assert list(found) == ["system"] and found.to_dict()["theory"] == "nonlinear"


@pytest.mark.parametrize(
    "arguments, field",
    [
        ({"rpm": 300, "case_limit": 0}, "case_limit"),
        ({"rpm": 300, "case_limit": float("nan")}, "case_limit"),
        ({"rpm": 300, "case_limit": "long"}, "case_limit"),
        ({"rpm": (300, 400, 50)}, "rpm"),
        ({"rpm": 300, "rods": "none"}, "rods"),
        ({"rpm": 300, "period": 2}, "period"),
    ],
)
def test_a_bench_refuses_by_name(six_link, arguments, field):
    with pytest.raises(hb.RequestError) as raised:
        six_link.bench(**arguments)
    assert raised.value.field == field and raised.value.found and raised.value.allowed


@pytest.mark.parametrize(
    "arguments, field",
    [
        ({"rpm": 300}, "rpm"),
        ({"rpm": (900, 300, 50)}, "rpm"),
        ({"rpm": (300, 900)}, "rpm"),
        ({"rpm": (300, 900, 0)}, "rpm"),
        ({"rpm": (300, float("nan"), 1)}, "rpm"),
        ({"rpm": (-300, 900, 50)}, "x"),
        ({"rpm": "300:900"}, "rpm"),
        ({"rpm": [300, 200]}, "x"),
        ({"rpm": [300]}, "x"),
        ({"rpm": []}, "x"),
        ({"rpm": np.full(3, np.nan)}, "rpm"),
        ({"rpm": (300, 900, 50), "omega": 3}, "omega"),
        ({"x": "AB.J"}, "x"),
        ({"x": 3}, "x"),
        ({}, "rpm"),
        ({"rpm": (300, 900, 50), "threads": 0}, "threads"),
        ({"rpm": (300, 900, 50), "threads": "many"}, "threads"),
        ({"rpm": (300, 900, 50), "rods": "none"}, "rods"),
        ({"rpm": (300, 900, 50), "progress": 3}, "progress"),
        ({"rpm": (300, 900, 50), "theory": "quadratic"}, "theory"),
        ({"rpm": (300, 900, 50), "period": 2}, "period"),
    ],
)
def test_a_sweep_refuses_by_name(six_link, arguments, field):
    with pytest.raises(hb.RequestError) as raised:
        six_link.sweep(**arguments)
    assert raised.value.field == field
    assert raised.value.found and raised.value.allowed
    assert "--" not in str(raised.value)


@pytest.mark.parametrize(
    "arguments, field",
    [
        ({"x": "rpm=1:2:3", "y": "omega=1:2:3"}, "y"),
        ({"x": "AB.J=1:2:3", "y": "*.J=1:2:3", "rpm": 300}, "y"),
        ({"x": "rpm=1:2:3", "y": None}, "y"),
        ({"x": "rpm=1:2:1", "y": "AB.J=1:2:3"}, "x"),
        ({"x": "rpm=-1:2:3", "y": "AB.J=1:2:3"}, "x"),
        ({"x": "rpm=1:2:3", "y": "AB.J=1:2:3", "rpm": 300}, "rpm"),
        ({"x": "rpm=1:2:3000", "y": "AB.J=1:2:3000"}, "x, y"),
        ({"x": "analysis.modes=1:2:3", "y": "AB.J=1:2:3"}, "x"),
    ],
)
def test_a_map_refuses_by_name(six_link, arguments, field):
    with pytest.raises(hb.RequestError) as raised:
        six_link.map(**arguments)
    assert raised.value.field == field
    assert raised.value.found and raised.value.allowed


def test_unknown_numbers_of_a_map_are_scene_errors(six_link):
    with pytest.raises(hb.SceneError):
        six_link.map(x="rpm=1:2:3", y="AB.Q=1:2:3")


def test_progress_is_told(four_bar, capfd):
    told = []
    four_bar.sweep(rpm=(300, 3000, 2), modes=1, only="steady", progress=lambda *a: told.append(a))
    assert told and all(isinstance(what, str) and 0 <= done <= total for what, done, total in told)
    four_bar.sweep(rpm=(300, 3000, 2), modes=1, only="steady", progress=True)
    assert " of " in capfd.readouterr().err


def test_an_error_of_the_progress_function_ends_the_work(four_bar):
    class Mine(Exception):
        pass

    def progress(what, done, total):
        raise Mine

    with pytest.raises(Mine):
        four_bar.sweep(rpm=(200, 60000, 0.5), progress=progress)


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_ends_long_work(four_bar, threads):
    timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    start = time.monotonic()
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        four_bar.sweep(rpm=(200, 60000, 0.5), threads=threads)
    assert time.monotonic() - start < 20
    timer.join()
    assert four_bar.steady(rpm=300)["AB" if "AB" in four_bar.rods else four_bar.rods[0]].verdict


def test_the_lock_is_free_during_long_work(four_bar):
    ticks = []
    done = threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.01)

    thread = threading.Thread(target=tick)
    thread.start()
    start = time.monotonic()
    four_bar.sweep(rpm=(300, 3000, 5), modes=1, only="steady")
    end = time.monotonic()
    done.set()
    thread.join()
    assert sum(start < t < end for t in ticks) >= 2


def test_pickles_keep_the_document_and_compute_the_rest_anew(sweep):
    again = pickle.loads(pickle.dumps(sweep))
    assert again.to_dict() == sweep.to_dict()
    name = next(iter(sweep))
    assert (again[name].growth_rate == sweep[name].growth_rate).all()
    assert str(again) == str(sweep)
