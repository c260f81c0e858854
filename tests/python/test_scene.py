"""Scenes from files, texts and dicts, and what is said of wrong ones."""

import pickle
import tomllib

import numpy as np
import pytest
from conftest import SCENES, command

import hb


def test_file_text_and_dict_are_one_scene(six_link):
    text = (SCENES / "six_link.toml").read_text()
    from_text = hb.loads(text)
    from_dict = hb.Scene.from_dict(tomllib.loads(text))
    documents = [scene.steady(rpm=300).to_dict() for scene in (six_link, from_text, from_dict)]
    assert documents[0] == documents[1] == documents[2]
    assert six_link.to_dict() == tomllib.loads(text)
    assert hb.Scene.from_dict(six_link.to_dict()).to_dict() == six_link.to_dict()


def test_a_dict_takes_arrays_and_numpy_numbers():
    matrix = np.array([[2.0, 0.1], [0.1, 1.0]])
    scene = hb.Scene.from_dict(
        {"hill": {"mass": np.eye(2), "damping": 0.1 * matrix, "stiffness": [{"harmonic": np.int64(0), "cos": matrix}]}}
    )
    assert scene.rods == ["system"]
    assert scene["hill.damping.0.1"] == 0.1 * 0.1


def test_a_changed_copy_is_set_of_the_command(six_link):
    changed = six_link.with_({"AB.J": 60, "*.damping_internal": 2e-4})
    flags = ["--rpm", "300", "--set", "AB.J=60", "--set", "*.damping_internal=2e-4"]
    assert changed.steady(rpm=300).to_dict() == command("steady", SCENES / "six_link.toml", *flags)
    assert changed["AB.J"] == 60 and changed["CD.damping_internal"] == 2e-4
    assert six_link["AB.J"] == 45
    assert six_link.with_({"AB.E": "210 GPa"})["AB.E"] == 210e6
    assert six_link.with_({"O2BC.pivot": [270, 1]})["O2BC.pivot.1"] == 1
    assert six_link.with_({"analysis.modes": 3}).steady(only="steady")["AB"].modes == 3


def test_a_scene_tells_what_it_is(six_link):
    assert six_link.title == "Six-link mechanism"
    assert six_link.units == {"length": "mm", "mass": "kg", "time": "s", "angle": "rad"}
    assert six_link.rods == ["AB", "CD"]
    assert "AB.J" in six_link.paths and six_link["crank.length"] == 55
    assert six_link.understood() == command("scene", SCENES / "six_link.toml")
    assert "AB" in repr(six_link) and "Six-link" in str(six_link)


def test_relative_files_are_taken_from_the_folder():
    text = (SCENES / "slider_crank.toml").read_text()
    by_text, by_file = (scene.steady().to_dict() for scene in (hb.loads(text, folder=SCENES), hb.load(SCENES / "slider_crank.toml")))
    by_text.pop("warnings"), by_file.pop("warnings")  # they name the file
    assert by_text == by_file
    with pytest.raises(hb.SceneError):
        hb.loads(text, folder="/")


def test_pickles_are_the_text(six_link):
    again = pickle.loads(pickle.dumps(six_link.with_({"AB.J": 50})))
    assert again["AB.J"] == 50 and again.text == six_link.with_({"AB.J": 50}).text


def test_an_error_names_file_line_key_found_and_allowed(tmp_path):
    file = tmp_path / "wrong.toml"
    file.write_text((SCENES / "six_link.toml").read_text().replace("length = 259", "length = -259"))
    with pytest.raises(hb.SceneError) as raised:
        hb.load(file)
    error = raised.value
    assert error.file == str(file)
    assert error.line == 14
    assert error.key.endswith("length")
    assert "-259" in error.found and "number > 0" in error.allowed
    assert str(error).startswith(f"{file}:14: ")
    assert isinstance(error, ValueError)


@pytest.mark.parametrize(
    "text",
    ["", "a =", "title = 3", "[hill]\nmass = [[1]]", "[crank]\nlength = 1", "\x00", "[[dyad]]\n", "x = 1\n" * 3, "é" * 100],
)
def test_wrong_texts_are_scene_errors(text):
    with pytest.raises(hb.SceneError):
        hb.loads(text)


def test_all_problems_are_told(tmp_path):
    text = (SCENES / "six_link.toml").read_text().replace("length = 259", "length = -259").replace("J = 45", "J = 0")
    with pytest.raises(hb.SceneError) as raised:
        hb.loads(text)
    assert len(raised.value.problems) == 3
    assert pickle.loads(pickle.dumps(raised.value)).problems == raised.value.problems


@pytest.mark.parametrize(
    "changes, key",
    [({"AB.J": -1}, "AB.elastic.J"), ({"AB.Q": 1}, "AB.Q"), ({"AB.J": float("nan")}, "AB.elastic.J"), ({"AB.E": "2 kg"}, "AB.elastic.E")],
)
def test_a_wrong_change_is_a_scene_error(six_link, changes, key):
    with pytest.raises(hb.SceneError) as raised:
        six_link.with_(changes)
    assert raised.value.key == key
    assert raised.value.found and raised.value.allowed


@pytest.mark.parametrize("changes", [3, {3: 4}, {"AB.J": object()}, {"AB.J": None}, ["AB.J=3"]])
def test_a_change_of_a_wrong_type_is_a_request_error(six_link, changes):
    with pytest.raises(hb.RequestError) as raised:
        six_link.with_(changes)
    assert raised.value.field and raised.value.found and raised.value.allowed


def test_a_missing_file_is_a_scene_error(tmp_path):
    with pytest.raises(hb.SceneError) as raised:
        hb.load(tmp_path / "none.toml")
    assert raised.value.file == str(tmp_path / "none.toml")
    for wrong in (None, 3, b"scene.toml"):
        with pytest.raises(hb.RequestError):
            hb.load(wrong)
    with pytest.raises(hb.RequestError):
        hb.loads(3)


def test_an_unknown_path_names_the_nearest(six_link):
    with pytest.raises(hb.SceneError, match="AB.J"):
        six_link["AB.K"]
