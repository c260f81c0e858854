"""The types that the package states are those that it has."""

import importlib.util
import os
import pathlib
import subprocess
import sys

import pytest

import hb

HERE = pathlib.Path(__file__).parent
CONFIG = str(HERE / "mypy.ini")


def run(tmp_path, *words):
    folder = pathlib.Path(hb.__file__).parent
    return subprocess.run(
        [sys.executable, "-m", *words],
        cwd=tmp_path,
        env={**os.environ, "MYPYPATH": str(folder.parent), "MYPY_CACHE_DIR": str(tmp_path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is missing")
def test_stubs_match_the_compiled_half_and_types_the_rest(tmp_path):
    assert pathlib.Path(hb.__file__).with_name("py.typed").exists()
    allowed = str(HERE / "stubtest.txt")
    stubs = run(tmp_path, "mypy.stubtest", "hb._core", "--concise", "--allowlist", allowed, "--mypy-config-file", CONFIG)
    assert stubs.returncode == 0, stubs.stdout.decode()
    types = run(tmp_path, "mypy", "-p", "hb", "--config-file", CONFIG)
    assert types.returncode == 0, types.stdout.decode()
