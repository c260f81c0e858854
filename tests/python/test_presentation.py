"""Tables, pictures, pages and notebooks."""

import json
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest
from conftest import SCENES

import hb


@pytest.fixture(scope="module")
def sweep():
    return hb.load(SCENES / "four_bar.toml").sweep(rpm=(300, 1500, 100), modes=2)


@pytest.fixture(scope="module")
def map():
    x, y = "omega=1.9:2.5:13", "hill.stiffness.1.cos.0.0=0.1:0.5:9"
    return hb.load(SCENES / "mathieu.toml").map(x=x, y=y)


def test_only_numpy_is_needed():
    code = (
        "import sys; sys.modules.update(dict.fromkeys(['matplotlib', 'pandas', 'xarray', 'scipy']))\n"
        f"import hb; m = hb.load({str(SCENES / 'six_link.toml')!r}); s = m.steady(rpm=300); str(s); s.to_dict()\n"
        "m.sweep(rpm=(300, 500, 100), modes=1)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_what_is_missing_is_named_with_its_package():
    """`plot()` without matplotlib ended in a bare ImportError."""
    code = (
        "import sys; sys.modules.update(dict.fromkeys(['matplotlib', 'pandas', 'xarray']))\n"
        "import hb\n"
        f"m = hb.load({str(SCENES / 'six_link.toml')!r}); s = m.steady(rpm=300, modes=1)\n"
        "w = m.sweep(rpm=(300, 500, 100), modes=1); p = m.map(x='rpm=300:500:3', y='AB.J=40:50:2', modes=1)\n"
        "c = m.check(rpm=300, modes=1)\n"
        "calls = [m.plot, s.plot, s['AB'].plot, w.plot, w['AB'].plot, p.plot, c.plot]\n"
        "calls += [r.to_frame for r in (s, s['AB'], w, w['AB'], p, c)] + [r.to_xarray for r in (s, w, p)]\n"
        "for call in calls:\n"
        "    try: call()\n"
        "    except hb.MissingPackage as error: print(call.__name__, error)\n"
    )
    said = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.splitlines()
    assert len(said) == 16
    for line in said:
        name, package = {"plot": ("plot()", "matplotlib"), "to_frame": ("to_frame()", "pandas"), "to_xarray": ("to_xarray()", "xarray")}[
            line.split()[0]
        ]
        assert f"{name} needs the package {package}" in line and f"apt install python3-{package}" in line


def test_a_frame_has_the_commands_table(steady):
    pytest.importorskip("pandas")
    frame = steady["AB"].to_frame()
    assert list(frame.columns[:2]) == ["crank angle [deg]", "q_1 [mm]"]
    assert frame["q_1 [mm]"].abs().max() == pytest.approx(steady["AB"].max_abs[0], rel=1e-3)
    assert list(steady.to_frame().index.get_level_values("rod").unique()) == ["AB", "CD"]
    assert "AB.0 x [N]" in " ".join(steady.to_frame("joint_forces").columns)
    for what in ("fourier", "deflection", "bending_moment", "exponents", "torque"):
        assert len(steady.to_frame(what)) > 0
    with pytest.raises(hb.RequestError):
        steady.to_frame("everything")


def test_a_sweeps_frame_has_its_numbers(sweep):
    pytest.importorskip("pandas")
    frame = sweep.to_frame()
    assert frame.index.name == "rpm" and (frame.index == sweep.x).all()
    for name, rod in sweep.rods.items():
        assert (frame[name, "growth_rate"] == rod.growth_rate).all()
        assert (frame[name, "max_abs_2"] == rod.max_abs[:, 1]).all()
        assert len(rod.to_frame()) >= len(sweep)


def test_datasets_have_the_numbers(sweep, map, steady):
    pytest.importorskip("xarray")
    dataset = sweep.to_xarray()
    for name, rod in sweep.rods.items():
        assert (dataset["growth_rate"].sel(rod=name).values == rod.growth_rate).all()
        assert (dataset["max_abs"].sel(rod=name).values == rod.max_abs).all()
    assert (map.to_xarray()["growth_rate"].values == map.growth_rate).all()
    turn = steady.to_xarray()
    assert (turn["q_AB"].values == steady["AB"].response(turn["crank_angle"].values)).all()
    assert turn["AB.0 elastic"].dims == ("direction", "crank_angle")


def test_pictures_come_as_axes(steady, sweep, map, six_link):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    axes = [six_link.plot(), steady.plot(), steady.plot(kind="torque"), map.plot()]
    axes += [steady["AB"].plot(kind) for kind in ("response", "spectrum", "phase", "deflection", "bending_moment", "exponents")]
    axes += [sweep.plot(kind) for kind in ("campbell", "growth", "peaks", "deflection")]
    for ax in axes:
        assert ax.get_title(loc="left")
        ax.figure.canvas.draw()
    given = pyplot.figure().add_subplot()
    assert steady["AB"].plot(ax=given) is given
    assert sweep.plot("growth", ax=given) is given
    pyplot.close("all")
    for wrong in (steady, steady["AB"], sweep):
        with pytest.raises(hb.RequestError) as raised:
            wrong.plot(kind="cake")
        assert raised.value.field == "kind" and "growth" in raised.value.allowed + "growth"
    pyplot.close("all")


def test_colours_are_the_commands(map):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    ax = map.plot()
    drawn = {line.get_color(): line.get_label() for line in ax.get_lines()}
    assert drawn.get("#000000") == "boundary −1: period doubling"
    commands = (SCENES.parents[1] / "tools/pictures/map_plot.cpp").read_text()
    assert f'"#000000", "{drawn["#000000"]}"' in commands
    bands = hb.load(SCENES / "mathieu.toml").sweep(omega=(1.9, 2.5, 0.1)).plot("growth")
    assert any(patch.get_facecolor()[:3] == pytest.approx((0xD5 / 255, 0x5E / 255, 0)) for patch in bands.patches)
    pyplot.close("all")


def test_a_maps_picture_says_where_the_linear_theory_holds(six_link):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    map = six_link.map(x="rpm=300:3000:4", y="AB.J=40:50:3", modes=2, boundaries=False)
    assert [place["beyond"] for place in map.theory_sample] == [False, True, False, True]
    ax = map.plot()
    assert "beyond it at 2 of 4 points looked at" in ax.get_title(loc="left")
    assert {"beyond the linear theory", "within the linear theory"} <= {line.get_label() for line in ax.get_lines()}
    pyplot.close("all")


def test_a_picture_without_its_quantity_is_refused():
    pytest.importorskip("matplotlib.pyplot")
    sweep = hb.load(SCENES / "mathieu.toml").sweep(omega=(1.9, 2.5, 0.1), only="stability")
    with pytest.raises(hb.RequestError):
        sweep.plot("peaks")


def test_a_notebook_shows_words_and_drawing(six_link, steady, sweep, map, mathieu):
    for result in (six_link, steady, sweep, map, mathieu):
        assert "<pre" in result._repr_html_()
        assert len(str(result)) > 100 and repr(result).startswith("<hb.")
    assert mathieu._repr_svg_() is None
    if shutil.which("gnuplot"):
        assert "<svg" in six_link._repr_svg_()


@pytest.mark.skipif(not pathlib.Path("/usr/share/javascript/dygraphs").exists(), reason="libjs-dygraphs is missing")
def test_pages_are_written_whole(tmp_path, six_link, steady, sweep, map):
    sweep.report(tmp_path / "sweep.html")
    map.report(tmp_path / "map.html")
    steady.report(tmp_path / "steady.html")
    check = six_link.check(rpm=300, modes=1)
    check.report(tmp_path / "check.html")
    page = (tmp_path / "check.html").read_text()
    assert "The paths agree within the sum of their error bars." in page and "<svg" in page
    six_link.report(tmp_path / "both.html", rpm=(200, 400, 100), x="rpm=200:400:4", y="*.J=40:60:3", modes=1, pictures=False)
    for name in ("sweep", "map", "steady", "both"):
        page = (tmp_path / f"{name}.html").read_text()
        assert page.startswith("<!DOCTYPE html>") and page.rstrip().endswith("</html>")
    assert 'id="speed"' in (tmp_path / "sweep.html").read_text()
    assert 'id="map"' in (tmp_path / "both.html").read_text()


@pytest.mark.skipif(not pathlib.Path("/usr/share/javascript/dygraphs").exists(), reason="libjs-dygraphs is missing")
def test_a_page_has_the_bands_of_its_answer(tmp_path, six_link):
    steady = six_link.steady(rpm=300, modes=1, band="damping=0.5:2")
    steady.report(tmp_path / "band.html")
    page = (tmp_path / "band.html").read_text()
    inside = json.loads(re.search('<script type="application/json" id="report-data">(.*?)</script>', page, re.S)[1])
    assert inside["bands"] == steady.to_dict()["bands"]
    sweep = six_link.sweep(rpm=(200, 400, 100), modes=1, band="damping=0.5:2")
    sweep.report(tmp_path / "bands.html")
    page = (tmp_path / "bands.html").read_text()
    (band,) = json.loads(re.search('<script type="application/json" id="report-data">(.*?)</script>', page, re.S)[1])["sweep_bands"]
    growth = next(row for row in band["largest"] if row["name"].startswith("AB growth rate"))
    document = sweep.to_dict()
    ends = [document["bands"][0][end]["rods"]["AB"]["growth_rate"] for end in ("at_from", "at_to")]
    assert [growth["from"], growth["given"], growth["to"]] == [max(ends[0]), max(document["rods"]["AB"]["growth_rate"]), max(ends[1])]


def test_pages_that_cannot_be_written_are_told(steady, tmp_path):
    with pytest.raises(OSError):
        steady.report(tmp_path / "none" / "page.html")
    for wrong in (None, 3, ""):
        with pytest.raises(hb.RequestError):
            steady.report(wrong)
