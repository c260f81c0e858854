"""Scenes of the tests, from tests/scenes or made up here."""

import pathlib

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "scenes"

HOSTILE_TITLE = """</title></script><script>window.harmed = 1</script>'\"&]]><!-- ${{x}} {{title}} <img src=x onerror=window.harmed=2>"""
HOSTILE_ROD = "<b>&amp<script>{{name}}]]>"
HOSTILE_COMMENT = "# </pre></details></script><script>window.harmed = 3</script><!-- {{{data}}}"


def toml_text(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def hostile(title=HOSTILE_TITLE, rod=HOSTILE_ROD):
    text = (FOLDER / "four_bar.toml").read_text()
    lines = [line for line in text.splitlines() if not line.startswith("title")]
    text = "\n".join([HOSTILE_COMMENT, f"title = {toml_text(title)}"] + lines) + "\n"
    return text.replace('name = "coupler"', f"name = {toml_text(rod)}")
