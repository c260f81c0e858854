"""The package as its users meet it, beside the command: HB_COMMAND is the program, HB_SOURCE_DIR the repository."""

import json
import os
import pathlib
import subprocess

import pytest

import hb

SOURCE = pathlib.Path(os.environ["HB_SOURCE_DIR"])
SCENES = SOURCE / "tests" / "scenes"


def command(*words):
    """The document that the command prints."""
    run = subprocess.run(
        [os.environ["HB_COMMAND"], *map(str, words), "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False
    )
    assert run.returncode in (0, 1, 3), run.stderr.decode()
    return json.loads(run.stdout)


@pytest.fixture(scope="session")
def six_link():
    return hb.load(SCENES / "six_link.toml")


@pytest.fixture(scope="session")
def slider_crank():
    return hb.load(SCENES / "slider_crank.toml")


@pytest.fixture(scope="session")
def mathieu():
    return hb.load(SCENES / "mathieu.toml")


@pytest.fixture(scope="session")
def steady(six_link):
    return six_link.steady(rpm=300)
