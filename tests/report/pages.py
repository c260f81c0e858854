"""What tests of reports in a real browser share: the command, its pages made once, a browser."""

import html.parser
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import browser
import scenes

HB = ""


def run(*arguments):
    return subprocess.run([HB, *map(str, arguments)], capture_output=True, text=True, timeout=1200)


def answer(*arguments):
    """The JSON document of a command."""
    done = run(*arguments, "--json")
    if done.returncode not in (0, 3):
        raise AssertionError(done.stderr)
    return json.loads(done.stdout)


class Ids(html.parser.HTMLParser):
    """Elements with an id, as the file has them."""

    def __init__(self, text):
        super().__init__()
        self.found = {}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if "id" in attributes:
            self.found[attributes["id"]] = (tag, attributes)


def at(document, path):
    """document["a"]["b"][0] for ("a", "b", "0"): names may hold dots, so the longest that fits counts."""
    parts = path.split(".")
    while parts:
        for count in range(len(parts), 0, -1):
            key = ".".join(parts[:count])
            if isinstance(document, list) and count == 1:
                document, parts = document[int(key)], parts[1:]
                break
            if isinstance(document, dict) and key in document:
                document, parts = document[key], parts[count:]
                break
        else:
            raise KeyError(path)
    return document


class PageTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder_holder = tempfile.TemporaryDirectory(prefix="hb-report-")
        cls.folder = pathlib.Path(cls.folder_holder.name)
        cls.pages = {}
        cls.browser = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.folder_holder.cleanup()

    # Pages are made once, when a test first asks for them.
    def page(self, name, *arguments):
        if name not in self.pages:
            path = self.folder / f"{name}.html"
            done = run("report", *arguments, "--out", path)
            self.assertIn(done.returncode, (0, 3), done.stderr)
            self.pages[name] = path
        return self.pages[name]

    # Of the pages of the six-link mechanism: its map with five takes minutes.
    MODES = ("--modes", "2")

    def six_link(self):
        return self.page("six_link", scenes.FOLDER / "six_link.toml", *self.MODES, "--rpm", "300:3000:300", "--x", "rpm=300:3000:7",
                         "--y", "*.J=30:90:4")

    # Through the folds of the six-link mechanism: unstable between them, at large deflections.
    NONLINEAR = ("--rpm", "1440:1500:20", "--modes", "1", "--theory", "nonlinear")

    def nonlinear(self):
        return self.page("nonlinear", scenes.FOLDER / "six_link.toml", *self.NONLINEAR)

    def mathieu(self):
        return self.page("mathieu", scenes.FOLDER / "mathieu.toml", "--omega", "0.5:2.5:0.1")

    def written(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def assert_quiet(self):
        self.assertEqual(self.browser.console(), [])


def main():
    """The tests of the file that was started: python3 FILE HB."""
    global HB
    HB = sys.argv.pop(1)
    lacking = browser.missing_parts()
    if lacking:
        print("skipped: not installed:", ", ".join(lacking))
        sys.exit(browser.MISSING)
    with tempfile.TemporaryDirectory() as holder:
        tried = run("report", scenes.FOLDER / "four_bar.toml", "--rpm", "100:200:100", "--out", pathlib.Path(holder) / "r.html")
    if "libjs-dygraphs" in tried.stderr:
        print("skipped:", tried.stderr.strip())
        sys.exit(browser.MISSING)
    unittest.main(verbosity=2)
