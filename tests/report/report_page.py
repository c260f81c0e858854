"""Reports in a real browser: python3 report_page.py HB, where HB is the built command."""

import fcntl
import html
import json
import math
import pathlib
import re
import tempfile
import unittest
import zlib

import pages
import scenes
from pages import Ids, PageTest, answer, at, run


class ReportPages(PageTest):
    def test_page_loads_from_disk_without_asking_any_network_and_without_console_errors(self):
        page = self.six_link()
        self.browser.open(page)
        self.browser.settled()
        self.assertEqual(self.browser.requests(), [page.as_uri()])
        self.assert_quiet()

    def test_ids_that_others_read_are_in_the_file_before_any_script_runs(self):
        found = Ids(self.six_link().read_text()).found
        for name in ("speed", "rpm-value", "verdict-AB", "verdict-CD", "campbell-AB", "campbell-CD", "mechanism", "map"):
            self.assertIn(name, found)
        tag, attributes = found["speed"]
        self.assertEqual((tag, attributes["type"], attributes["min"], attributes["max"], attributes["value"]),
                         ("input", "range", "0", "9", "0"))

    def test_slider_shows_the_numbers_of_hb_steady_at_three_speeds(self):
        scene = scenes.FOLDER / "six_link.toml"
        self.browser.open(self.six_link())
        for index, rpm in ((0, 300), (4, 1500), (9, 3000)):
            self.browser.choose(index)
            steady = answer("steady", scene, *self.MODES, "--rpm", rpm)
            self.assertEqual(self.browser.text("rpm-value"), json.dumps(steady["rpm"]))
            for rod in ("AB", "CD"):
                self.assertEqual(self.browser.text(f"verdict-{rod}"), steady["rods"][rod]["verdict"])
            shown = self.browser.run("return [...document.querySelectorAll('#numbers [data-value]')]"
                                     ".map((c) => [c.dataset.path, c.dataset.value])")
            self.assertGreater(len(shown), 40)
            for path, value in shown:
                if not path.startswith(("joints", "torque")):
                    self.assertEqual(float(value), at(steady, path), path)
                    continue
                whole, _, end = path.rpartition(".")
                rigid = whole.endswith("_rigid") and whole.startswith("torque")
                expected = at(steady, f"torque.rigid.{end}" if rigid else path)
                self.assertEqual(float(value), expected, path)
            paths = {path for path, _ in shown}
            for path in ("rods.AB.stress.axial", "rods.CD.axial_force.buckling_share", "bearings.AB.0.max", "frame.max", "power.rms",
                         "torque.mean", "flywheel.energy_fluctuation"):
                self.assertIn(path, paths)
        self.assert_quiet()

    def test_page_of_one_speed_shows_bands_and_what_the_machine_feels_with_units(self):
        arguments = ("steady", scenes.FOLDER / "slider_crank_units.toml", "--rpm", 3000, "--band", "damping=0.5:2", "--band", "E=0.9:1.1")
        done = run(*arguments, "--out", self.folder / "band", "--html")
        self.assertEqual(done.returncode, 0, done.stderr)
        steady = answer(*arguments)
        self.browser.open(self.folder / "band" / "report.html", "#play=0")
        self.browser.settled()
        bands = self.browser.run("return document.getElementById('bands').textContent")
        for band in steady["bands"]:
            self.assertIn(f"{band['parameter']} of the elastic links times", bands)
            for quantity in band["quantities"]:
                self.assertIn(f"{quantity['of']}: {quantity['name']}", bands)
        self.browser.run("document.querySelectorAll('#numbers details').forEach((d) => { d.open = true })")
        numbers = self.browser.run("return document.getElementById('numbers').textContent")
        stress = steady["rods"]["rod"]["stress"]["axial"] * 1e-6
        self.assertIn(f"largest axial stress{stress:.4g}"[:22], numbers)
        for words in ("MPa", "largest shaking force on the frame", "driving torque, root mean square", "velocity", "J a turn"):
            self.assertIn(words, numbers)
        self.assert_quiet()

    def test_every_view_moves_with_the_slider(self):
        self.browser.open(self.six_link(), "#play=0")
        # In sight, so that they are drawn.
        self.browser.resize(1300, 9000)
        self.browser.settled()
        picture = ("const pictures = {}; document.querySelectorAll('#mechanism, #rods canvas, #forces canvas, #map')"
                   ".forEach((c, k) => { pictures[k + ' ' + (c.getAttribute('aria-label') || '').split(':')[0]] = c.toDataURL() });"
                   "return pictures")
        before = self.browser.run(picture)
        self.browser.choose(3)
        self.browser.settled()
        after = self.browser.run(picture)
        self.browser.resize(1300, 900)
        self.assertGreaterEqual(len(before), 13)
        self.assertEqual([name for name in before if before[name] == after[name]], [])

    def test_arrow_keys_on_the_slider_step_through_the_speeds(self):
        from selenium.webdriver.common.keys import Keys
        self.browser.open(self.six_link())
        slider = self.browser.element("speed")
        slider.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT)
        self.assertEqual(self.browser.text("rpm-value"), "900.0")
        slider.send_keys(Keys.END)
        self.assertEqual(self.browser.text("rpm-value"), "3000.0")

    def test_click_in_the_campbell_diagram_goes_to_the_nearest_computed_speed(self):
        from selenium.webdriver.common.action_chains import ActionChains
        self.browser.open(self.six_link())
        chart = self.browser.element("campbell-CD")
        self.browser.run("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", chart)
        for share in (-0.2, 0.31):
            self.browser.settled()
            offset = int(share * chart.size["width"])
            ActionChains(self.browser.driver).move_to_element_with_offset(chart, offset, 20).click().perform()
            # The plot's own axis, from the places of two of its numbers.
            ticks = self.browser.run(
                "return [...arguments[0].querySelectorAll('.dygraph-axis-label-x')].map((t) => { const b = t.getBoundingClientRect();"
                "return [b.left + b.width / 2, Number(t.textContent)] })", chart)
            (a, x), (b, y) = ticks[0], ticks[-2]
            box = self.browser.run("const b = arguments[0].getBoundingClientRect(); return [b.left, b.width]", chart)
            clicked = x + (box[0] + box[1] / 2 + offset - a) / (b - a) * (y - x)
            chosen = float(self.browser.text("rpm-value"))
            self.assertLessEqual(abs(chosen - clicked), 155, "half a step and what a label's rounding moves")
            self.assertEqual(self.browser.element("speed").get_attribute("value"), str(round((chosen - 300) / 300)))
        self.assert_quiet()

    def test_click_in_the_map_takes_the_speed_along_and_tells_the_computed_verdict(self):
        from selenium.webdriver.common.action_chains import ActionChains
        self.browser.open(self.six_link())
        canvas = self.browser.element("map")
        self.browser.run("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", canvas)
        self.browser.settled()
        ActionChains(self.browser.driver).move_to_element(canvas).click().perform()
        self.browser.settled()
        i, j = self.browser.run("return state.mapNode")
        table = answer("map", scenes.FOLDER / "six_link.toml", *self.MODES, "--x", "rpm=300:3000:7", "--y", "*.J=30:90:4")
        told = self.browser.run("return document.querySelector('.map-reading').textContent")
        self.assertIn(table["verdict"][j][i], told)
        chosen = float(self.browser.text("rpm-value"))
        self.assertLessEqual(abs(chosen - table["x"]["values"][i]), 150)
        self.assert_quiet()

    def test_verdict_letters_are_those_of_the_sweep_and_nothing_lies_between(self):
        sweep = answer("sweep", scenes.FOLDER / "six_link.toml", *self.MODES, "--rpm", "300:3000:300")
        self.browser.open(self.six_link())
        for rod in ("AB", "CD"):
            shown = self.browser.run("return [...Array(points.count).keys()].map((k) => verdictOf(arguments[0], k))", rod)
            self.assertEqual(shown, sweep["rods"][rod]["verdict"])

    def test_curves_over_the_turn_have_the_peaks_of_the_json(self):
        steady = answer("steady", scenes.FOLDER / "six_link.toml", *self.MODES, "--rpm", 1500)
        self.browser.open(self.six_link())
        self.browser.choose(4)
        for rod in ("AB", "CD"):
            peaks = self.browser.run("return responseOf(arguments[0]).map((c) => Math.max(...samplesOf(c, 1440).map(Math.abs)))", rod)
            for drawn, true in zip(peaks, steady["rods"][rod]["q"]["max_abs"]):
                self.assertLess(abs(drawn - true), 1e-4 * true)
        for joint, components in steady["joints"].items():
            for kind, suffix in (("elastic", ""), ("rigid", "_rigid")):
                extremes = self.browser.run(
                    "return jointSeries(arguments[0])[arguments[1]].map((c) => { const s = samplesOf(c, 1440);"
                    "return [Math.min(...s), Math.max(...s)] })", joint, kind)
                for component, (low, high) in zip(("x", "y"), extremes):
                    true = components[component + suffix]
                    size = max(abs(true["min"]), abs(true["max"]))
                    self.assertLess(max(abs(low - true["min"]), abs(high - true["max"])), 2e-4 * size, joint)

    def test_fragment_brings_back_what_the_sender_saw(self):
        self.browser.open(self.six_link(), "#speed=6&angle=120&play=0&magnification=50&joint=CD.1")
        self.assertEqual(self.browser.text("rpm-value"), "2100.0")
        self.assertEqual(self.browser.text("angle-value"), "120°")
        self.assertEqual(self.browser.run("return [state.magnification, state.joint, state.playing]"), [50, "CD.1", False])

    def test_play_moves_the_crank_and_pause_stops_it(self):
        self.browser.open(self.six_link(), "#play=0&angle=10")
        button = self.browser.element("play")
        self.assertEqual(button.text, "Play")
        self.browser.driver.execute_script("arguments[0].click()", button)
        self.browser.driver.execute_async_script("setTimeout(arguments[0], 300)")
        self.browser.driver.execute_script("arguments[0].click()", button)
        self.browser.settled()
        stopped = self.browser.run("return state.angle")
        self.assertGreater(stopped, math.radians(11))
        self.browser.driver.execute_async_script("setTimeout(arguments[0], 200)")
        self.assertEqual(self.browser.run("return state.angle"), stopped)

    def test_page_without_linearisation_shows_the_branch_of_the_sweep_at_every_speed(self):
        sweep = answer("sweep", scenes.FOLDER / "six_link.toml", *self.NONLINEAR)
        self.browser.open(self.nonlinear(), "#play=0")
        system = sweep["system"]
        for index, rpm in enumerate(sweep["rpm"]):
            self.browser.choose(index)
            branch = sweep["branches"][system["branch"][index]]
            for rod in ("AB", "CD"):
                self.assertEqual(self.browser.text(f"verdict-{rod}"), sweep["verdict"][index])
                shown = self.browser.run("return document.querySelector(`#numbers [data-path='rods.${arguments[0]}.q.max_abs.0']`).dataset.value", rod)
                self.assertEqual(float(shown), branch["rods"][rod]["max_abs"][system["point"][index]][0], rpm)
            growth = self.browser.run("return document.querySelector(`#numbers [data-path='system.growth_rate']`).dataset.value")
            self.assertEqual(float(growth), system["growth_rate"][index])
        self.assert_quiet()

    def test_page_without_linearisation_has_branches_folds_and_jumps(self):
        sweep = answer("sweep", scenes.FOLDER / "six_link.toml", *self.NONLINEAR)
        self.browser.open(self.nonlinear(), "#play=0")
        # Warnings of the linear answers stand beside the motion as what they are.
        notes = self.browser.text("notes")
        self.assertIn("Of the linear theory, which is drawn in grey here:", notes)
        self.assertNotIn("Tolerance not reached", notes)
        shown = self.browser.run("return peakBranches('AB', 0).map((b) => [b.verdicts, [...b.x]])")
        self.assertEqual([verdicts for verdicts, _ in shown], [b["verdict"] for b in sweep["branches"]])
        self.assertEqual([x for _, x in shown], [b["x"] for b in sweep["branches"]])
        self.assertEqual(self.browser.run("return nonlinear.folds.map((f) => f.x)"), sweep["folds"])
        tables = self.browser.text("tables-views")
        for fold in sweep["folds"]:
            self.assertIn(f"{fold:.2f}", tables)
        self.assertEqual(tables.count("upward") + tables.count("downward"), len(sweep["jumps"]))
        self.assert_quiet()

    def test_bent_mechanism_keeps_its_links_together(self):
        self.browser.open(self.nonlinear(), "#play=0")
        self.browser.choose(3)
        # Joint 1 of the bent rod, at the end of its chord, is joint 0 of the link behind it, and lies before the straight one.
        gaps = self.browser.run("""
            return [0, 1, 2, 3, 4, 5].map((angle) => {
              const poses = posesAt(motionHere(), angle), rod = poses.find((p) => p.body.name === 'AB');
              const others = poses.filter((p) => p !== rod).flatMap((p) => p.joints);
              return [Math.min(...others.map((z) => Math.hypot(z[0] - rod.joints[1][0], z[1] - rod.joints[1][1]))), rod.chord[40] / rod.body.length];
            })""")
        for gap, share in gaps:
            self.assertLess(gap, 5e-3)  # mm, of positions up to 600 kept to 1e-6 in each harmonic
            self.assertLess(share, 1)
        self.assertLess(min(share for _, share in gaps), 0.999)

    def test_html_of_steady_without_linearisation_has_its_numbers(self):
        arguments = ("steady", scenes.FOLDER / "six_link.toml", "--rpm", 1500, "--modes", 1, "--theory", "nonlinear")
        done = run(*arguments, "--out", self.folder / "steady", "--html")
        self.assertEqual(done.returncode, 0, done.stderr)
        steady = answer(*arguments)
        self.browser.open(self.folder / "steady" / "report.html", "#play=0")
        self.browser.settled()
        self.assertEqual(self.browser.text("rpm-value"), "1500.0")
        self.assertEqual(self.browser.text("verdict-AB"), steady["verdict"])
        shown = dict(self.browser.run("return [...document.querySelectorAll('#numbers [data-value]')].map((c) => [c.dataset.path, c.dataset.value])"))
        for path in ("system.growth_rate", "rods.AB.q.max_abs.0", "rods.CD.deflection.max_abs", "joints.AB.0.x.max", "torque.min"):
            self.assertEqual(float(shown[path]), at(steady, path), path)
        self.assertEqual(self.browser.text("numbers").count("Another motion"), len(steady["other_motions"]))
        self.assert_quiet()

    def test_titles_and_names_made_of_markup_do_no_harm(self):
        scene = self.written("hostile.toml", scenes.hostile())
        page = self.page("hostile", scene, "--rpm", "100:300:100")
        self.browser.open(page)
        self.browser.settled()
        self.assertIsNone(self.browser.run("return window.harmed"))
        self.assertEqual(self.browser.driver.title.strip(), scenes.HOSTILE_TITLE)
        self.assertIsNotNone(self.browser.element(f"verdict-{scenes.HOSTILE_ROD}"))
        self.assertIsNotNone(self.browser.element(f"campbell-{scenes.HOSTILE_ROD}"))
        self.assert_quiet()

    def test_title_of_a_megabyte_is_refused_and_comments_of_a_megabyte_are_cut(self):
        scene = self.written("title.toml", scenes.hostile(title="very long <b> " * 75000))
        done = run("report", scene, "--rpm", "100:300:100", "--out", self.folder / "title.html")
        self.assertEqual(done.returncode, 2)
        self.assertIn("title", done.stderr)
        self.assertFalse((self.folder / "title.html").exists())
        plain = self.page("hostile", self.written("hostile.toml", scenes.hostile()), "--rpm", "100:300:100")
        scene = self.written("comments.toml", scenes.hostile() + "# very long <b>\n" * 70000)
        page = self.page("comments", scene, "--rpm", "100:300:100")
        self.assertLess(page.stat().st_size, plain.stat().st_size + 400000)
        self.browser.open(page)
        self.assertEqual(self.browser.text("rpm-value"), "100.0")
        self.assert_quiet()

    def test_scene_without_a_title_is_called_by_its_file_whatever_its_name(self):
        text = scenes.hostile().replace("title = ", "# title = ")
        page = self.page("untitled", self.written("<script>x = 1<b>'&.toml", text), "--rpm", "100:300:100")
        self.browser.open(page)
        self.assertEqual(self.browser.driver.title, "<script>x = 1<b>'&.toml")
        self.assert_quiet()

    def test_hill_scene_says_that_it_has_no_mechanism_and_no_joints(self):
        page = self.mathieu()
        self.browser.open(page)
        self.browser.settled()
        self.assertIn("no mechanism", self.browser.element("mechanism").get_attribute("aria-label"))
        self.assertIn("no joints", self.browser.text("forces"))
        steady = answer("steady", scenes.FOLDER / "mathieu.toml", "--omega", 0.5)
        self.assertEqual(self.browser.text("verdict-system"), steady["rods"]["system"]["verdict"])
        self.assertEqual(float(self.browser.text("rpm-value")), steady["rpm"])
        self.assertIn("no map", self.browser.text("map-section"))
        self.assertIsNone(self.browser.element("map"))
        self.assert_quiet()

    def test_thinned_page_says_so_and_keeps_every_verdict(self):
        page = self.page("many", scenes.FOLDER / "mathieu.toml", "--omega", "0.5:2.5:0.002")
        sweep = answer("sweep", scenes.FOLDER / "mathieu.toml", "--omega", "0.5:2.5:0.002")
        self.browser.open(page)
        self.assertIn("1001 points", self.browser.text("notes"))
        shown = self.browser.run("return [...Array(points.count).keys()].map((k) => verdictOf('system', k))")
        self.assertEqual(shown, sweep["rods"]["system"]["verdict"])
        self.browser.choose(1)  # left out
        self.assertEqual(float(self.browser.text("rpm-value")), sweep["rpm"][1])
        self.assertEqual(self.browser.text("verdict-system"), sweep["rods"]["system"]["verdict"][1])
        self.assertIn("Left out", self.browser.text("numbers"))
        self.assert_quiet()

    def test_dark_scheme_turns_the_page_dark_and_paper_stays_light(self):
        self.browser.dark(True)
        try:
            self.browser.open(self.six_link())
            light = "return getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number).reduce((a, b) => a + b)"
            self.assertLess(self.browser.run(light), 150)
            self.browser.run("window.dispatchEvent(new Event('beforeprint'))")
            self.assertGreater(self.browser.run(light), 600)
        finally:
            self.browser.dark(False)

    def test_narrow_screen_needs_no_sideways_scrolling(self):
        self.browser.resize(390, 800)
        try:
            for page in (self.six_link(), self.mathieu()):
                self.browser.open(page)
                self.browser.settled()
                self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 390)
        finally:
            self.browser.resize(1300, 900)

    def test_pictures_and_slider_have_words_for_screen_readers(self):
        self.browser.open(self.six_link())
        self.browser.settled()
        silent = self.browser.run("return [...document.querySelectorAll('[role=img]')].filter((n) => !n.getAttribute('aria-label')).length")
        self.assertEqual(silent, 0)
        self.assertIn("300 rpm", self.browser.element("speed").get_attribute("aria-valuetext"))
        self.assertIn("AB stable", self.browser.element("speed").get_attribute("aria-valuetext"))


def document_of(page):
    """The data that a page holds."""
    return json.loads(re.search(r'<script type="application/json" id="report-data">(.*?)</script>', page.read_text(), re.S).group(1))


class ReportCommand(unittest.TestCase):
    def test_one_run_at_a_time_writes_a_page(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "report.html"
            lock = pathlib.Path(f"{path}.lock")
            lock.write_text("hb\nreport\n4711\n2000-01-01 00:00:00\n\n")
            with lock.open() as held:
                fcntl.flock(held, fcntl.LOCK_EX)
                done = run("report", scenes.FOLDER / "four_bar.toml", "--rpm", "100:200:100", "--out", path)
            self.assertEqual(done.returncode, 2)
            self.assertIn("is in use by report, process 4711", done.stderr)
            self.assertFalse(path.exists())
            # Of a run that was killed: its lock is taken, the file that it had begun is removed.
            begun = pathlib.Path(folder) / ".hb-report.html-abcdef"
            begun.write_text("half a page")
            lock.write_text(f"hb\nreport\n4711\n2000-01-01 00:00:00\n{begun}\n")
            done = run("report", scenes.FOLDER / "four_bar.toml", "--rpm", "100:200:100", "--no-plots", "--out", path)
            self.assertIn(done.returncode, (0, 3), done.stderr)
            self.assertIn("its lock", done.stderr)
            self.assertEqual([p.name for p in pathlib.Path(folder).iterdir()], ["report.html"])

    def test_page_says_where_it_comes_from(self):
        scene = scenes.FOLDER / "four_bar.toml"
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "report.html"
            run("report", scene, "--rpm", "100:200:100", "--no-plots", "--threads", 2, "--out", path)
            origin = document_of(path)["provenance"]
            self.assertEqual(origin["command"], f"hb report {scene} --rpm 100:200:100")
            self.assertEqual(origin["scene"], {"file": str(scene), "crc32": f"{zlib.crc32(scene.read_bytes()):08x}"})
            self.assertTrue(origin["program"].startswith("hb "))
            self.assertIn(html.escape(origin["command"]), path.read_text())

    def test_same_input_gives_the_same_bytes_with_any_number_of_threads(self):
        with tempfile.TemporaryDirectory() as folder:
            pages = []
            for threads in (1, 2):
                path = pathlib.Path(folder) / "report.html"
                done = run("report", scenes.FOLDER / "four_bar.toml", "--rpm", "100:400:100", "--threads", threads, "--out", path)
                self.assertIn(done.returncode, (0, 3), done.stderr)
                pages.append(path.read_bytes().replace(f"--threads {threads}".encode(), b""))
            self.assertEqual(pages[0], pages[1])

    def test_refused_requests_leave_no_file_and_name_what_is_allowed(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "report.html"
            scene = scenes.FOLDER / "four_bar.toml"
            for arguments in (["--rpm", "300"], ["--rpm", "300:100:10"], ["--rpm", "100:300:100", "--x", "rpm=100:300:5"],
                              ["--rpm", "100:300:100", "--theory", "exact"], ["--rpm", "100:300:100", "--period", "2"]):
                done = run("report", scene, *arguments, "--out", path)
                self.assertEqual(done.returncode, 2, arguments)
                self.assertIn("allowed", done.stderr)
                self.assertFalse(path.exists())
            done = run("report", scene, "--rpm", "100:300:100")
            self.assertEqual(done.returncode, 2)
            self.assertIn("--out", done.stderr)


if __name__ == "__main__":
    pages.main()
