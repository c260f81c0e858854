"""The types that the package states are those that it has."""

import importlib.util
import os
import pathlib
import subprocess
import sys

import pytest

import hb


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is missing")
def test_stubs_match_the_package(tmp_path):
    folder = pathlib.Path(hb.__file__).parent
    assert (folder / "py.typed").exists()
    run = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "hb", "--ignore-missing-stub", "--concise"],
        cwd=tmp_path,
        env={**os.environ, "MYPYPATH": str(folder.parent), "MYPY_CACHE_DIR": str(tmp_path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        check=False,
    )
    assert run.returncode == 0, run.stdout.decode()
