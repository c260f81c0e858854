"""The tutorials run as they stand, and write their pictures."""

import runpy
import sys

import pytest
from conftest import SOURCE

NAMES = ["first_slider_crank", "safe_to_6000_rpm", "choose_a_section", "mathieu_chart"]


@pytest.mark.parametrize("name", NAMES)
def test_a_tutorial_runs_and_draws(name, tmp_path, monkeypatch, capsys):
    pytest.importorskip("matplotlib")
    pytest.importorskip("scipy")
    monkeypatch.setattr(sys, "argv", [name, str(tmp_path)])
    runpy.run_path(str(SOURCE / "tools" / "python" / "tutorials" / f"{name}.py"), run_name="__main__")
    assert (tmp_path / f"{name}.png").stat().st_size > 10000
    assert capsys.readouterr().out


def test_every_tutorial_is_here():
    assert sorted(NAMES) == sorted(path.stem for path in (SOURCE / "tools" / "python" / "tutorials").glob("*.py"))
