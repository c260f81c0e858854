"""Designs: the command's document, the tuned scene, and what cannot be asked."""

import pickle

import pytest
from conftest import SCENES, command

import hb

FILE = SCENES / "slider_crank.toml"
FLAGS = ["--vary", "rod.J=500:2000", "--over", "rpm=800:1200", "--modes", "1", "--analyses", "12", "--speeds", "3"]
ARGUMENTS = {"vary": {"rod.J": (500, 2000)}, "over": (800, 1200), "modes": 1, "analyses": 12, "speeds": 3}


@pytest.fixture(scope="module")
def tuned():
    return hb.load(FILE).tune(minimise="deflection", keep=["stable>=5"], **ARGUMENTS)


def test_a_design_is_the_commands(tuned):
    assert tuned.to_dict() == command("tune", FILE, "--minimise", "deflection", "--keep", "stable>=5", *FLAGS)


def test_the_tuned_scene_has_the_numbers_found(tuned):
    document = tuned.to_dict()
    assert tuned.values == {"rod.J": document["variables"][0]["after"]}
    assert tuned.scene["rod.J"] == tuned.values["rod.J"]
    assert tuned.before["rod.J"] == 900
    assert tuned.goal == document["goal"] and tuned.conditions == document["conditions"]
    again = pickle.loads(pickle.dumps(tuned))
    assert again.to_dict() == document and again.scene.text == tuned.scene.text


def test_a_design_has_its_table_and_picture(tuned):
    pytest.importorskip("pandas")
    assert list(tuned.to_frame().columns[:2]) == ["rod.J", "goal"]
    pytest.importorskip("matplotlib.pyplot").close(tuned.plot().figure)


@pytest.mark.parametrize(
    "arguments, field",
    [
        ({}, "minimise, maximise"),
        ({"minimise": "mass", "maximise": "stable"}, "minimise, maximise"),
        ({"minimise": "beauty"}, "minimise"),
        ({"minimise": "mass", "vary": {}}, "vary"),
        ({"minimise": "mass", "vary": {"rod.J": (3, 2)}}, "vary rod.J"),
        ({"minimise": "mass", "vary": {"rod.J": 3}}, "vary rod.J"),
        ({"minimise": "mass", "vary": {"rod.J": (1, float("nan"))}}, "vary rod.J"),
        ({"minimise": "mass", "vary": {3: (1, 2)}}, "vary"),
        ({"minimise": "mass", "vary": 3}, "vary"),
        ({"minimise": "mass", "keep": "pretty"}, "keep"),
        ({"minimise": "mass", "over": 3}, "over"),
        ({"minimise": "mass", "over": (3, 2)}, "over rpm"),
        ({"minimise": "mass", "algorithm": "guess"}, "algorithm"),
        ({"minimise": "mass", "analyses": 0}, "analyses"),
        ({"minimise": "mass", "height": {"rod": 3}}, "height"),
    ],
)
def test_a_design_refuses_by_name(arguments, field):
    with pytest.raises(hb.RequestError) as raised:
        hb.load(FILE).tune(**{**ARGUMENTS, **arguments})
    assert raised.value.field == field
    assert raised.value.found
    assert "--" not in str(raised.value)


def test_unknown_numbers_are_scene_errors():
    with pytest.raises(hb.SceneError):
        hb.load(FILE).tune(**{**ARGUMENTS, "minimise": "mass", "vary": {"rod.Q": (1, 2)}})
