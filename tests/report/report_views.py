"""What single views of a report show, and how hands, keys and paper reach them: python3 report_views.py HB."""

import base64
import csv
import json
import shutil
import unittest

import pages
import scenes
from pages import PageTest, answer, run

CRANK = scenes.FOLDER / "slider_crank_units.toml"  # its rod has a section


class ReportViews(PageTest):
    SWEPT = ("--rpm", "1000:7000:500", "--modes", "3", "--no-plots")
    BANDS = ("--band", "damping=0.5:2", "--band", "E=0.9:1.1")

    def crank(self):
        return self.page("crank", CRANK, *self.SWEPT, *self.BANDS, "--x", "rpm=1000:7000:7", "--y", "rod.section.height=15mm:25mm:3")

    def focus(self, name):
        self.browser.run("document.getElementById(arguments[0]).focus()", name)

    def press(self, *keys):
        from selenium.webdriver.common.action_chains import ActionChains
        ActionChains(self.browser.driver).send_keys(*keys).perform()

    # Stress

    def test_stress_over_link_and_turn_is_that_of_the_files_of_steady(self):
        arguments = ("steady", CRANK, "--rpm", 5000, "--modes", 3)
        done = run(*arguments, "--out", self.folder / "stress", "--no-plots")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "stress" / "stress_rod.csv") as file:
            rows = [list(map(float, row)) for row in csv.reader(line for line in file if line[0].isdigit())]
        self.assertEqual(len(rows), 101)
        self.browser.open(self.crank(), "#speed=8&play=0")
        ranges = self.browser.run("""
            const field = new StressField(seriesOf(place(8).curves.rods.rod.stress)), ranges = [];
            for (let k = 0; k <= 20; ++k) for (const side of [1, -1]) {
              const values = Array.from({length: field.n}, (_, j) => field.value(3 * k, j, side) * megapascal);
              ranges.push([k, side, Math.min(...values), Math.max(...values)]);
            }
            return ranges""")
        largest = answer(*arguments)["rods"]["rod"]["stress"]["max_abs"] * 1e-6
        for place, side, low, high in ranges:
            expected = rows[5 * place][1:3] if side == 1 else rows[5 * place][3:5]
            self.assertAlmostEqual(low, expected[0], delta=5e-3 * largest)
            self.assertAlmostEqual(high, expected[1], delta=5e-3 * largest)

    def test_stress_map_marks_the_largest_reads_under_the_pointer_and_turns_the_crank(self):
        from selenium.webdriver.common.action_chains import ActionChains
        self.browser.open(self.crank(), "#speed=8&play=0")
        canvas = self.browser.run("return document.querySelector('[data-view=stress] canvas')")
        self.browser.run("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", canvas)
        self.browser.settled()
        stress = answer("steady", CRANK, "--rpm", 5000, "--modes", 3)["rods"]["rod"]["stress"]
        side = "right fibre" if stress["side"] == 1 else "left fibre"
        label = canvas.get_attribute("aria-label")
        self.assertIn(side, label)
        self.assertIn(f"largest {stress['max_abs'] * 1e-6:.4g} MPa", label)
        ActionChains(self.browser.driver).move_to_element(canvas).click().perform()
        self.browser.settled()
        self.assertIn("MPa", self.browser.run("return document.querySelector('[data-view=stress] .hover').textContent"))
        self.assertNotEqual(self.browser.run("return state.angle"), 0)
        before = self.browser.run("return arguments[0].toDataURL()", canvas)
        self.browser.run("const s = document.querySelector('[data-view=stress] ~ .toolbar select'); s.value = arguments[0]; s.dispatchEvent(new Event('change'))", str(-stress["side"]))
        self.browser.settled()
        self.assertNotEqual(self.browser.run("return arguments[0].toDataURL()", canvas), before)
        self.assert_quiet()

    def test_link_without_a_section_has_no_stress_map_and_says_why(self):
        self.browser.open(self.page("four_bar", scenes.FOLDER / "four_bar.toml", "--rpm", "100:300:100", "--modes", "1", "--no-plots"))
        self.assertIsNone(self.browser.run("return document.querySelector('[data-view=stress]')"))
        self.assertIn("where a link's section is given", self.browser.text("rods"))

    # Bands and what the theory leaves out

    def test_bands_of_a_sweep_are_what_the_three_curves_cover(self):
        sweep = answer("sweep", CRANK, *self.SWEPT[:-1], *self.BANDS)
        self.browser.open(self.crank(), "#play=0")
        self.browser.settled()
        for b, band in enumerate(sweep["bands"]):
            for key, i in (("max_abs", 0), ("max_abs", 2), ("growth_rate", None)):
                shown = self.browser.run("""
                    const [key, i, b] = arguments, along = report.along.rods.rod, x = doubles(report.along.x);
                    const columns = key === "growth_rate" ? [floats(along.growth_rate)] : along.max_abs.map(floats);
                    const {low, high} = bandsAround({name: "rod"}, key, x, columns, ["c1", "c2", "c3"])[b][i || 0];
                    return [[...low], [...high]]""", key, i, b)
                for k in range(len(sweep["rpm"])):
                    three = [side["rods"]["rod"][key][k] for side in (sweep, band["at_from"], band["at_to"])]
                    three = three if i is None else [each[i] for each in three]
                    for value, expected in ((shown[0][k], min(three)), (shown[1][k], max(three))):
                        self.assertAlmostEqual(value, expected, delta=1e-6 * abs(expected))
        picture = "return [...document.querySelectorAll('[data-chart=growth] canvas')].map((c) => c.toDataURL()).join()"
        self.browser.run("document.querySelector('[data-chart=growth]').scrollIntoView({behavior: 'instant'})")
        self.browser.settled()
        before = self.browser.run(picture)
        self.browser.run("const s = document.getElementById('shown-band'); s.value = '1'; s.dispatchEvent(new Event('change'))")
        self.browser.settled()
        self.assertNotEqual(self.browser.run(picture), before)
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('.legend .shaded')].map((s) => s.textContent)"), ["as given and with E times 0.9 to 1.1"] * 2)
        self.assert_quiet()

    def test_tables_have_the_largest_values_at_both_ends_of_a_band(self):
        sweep = answer("sweep", CRANK, *self.SWEPT[:-1], *self.BANDS)
        self.browser.open(self.crank(), "#play=0")
        shown = self.browser.run("return [...document.querySelectorAll('#sweep-bands table')].map((t) => [...t.querySelectorAll('tbody tr')]"
                                 ".map((r) => [...r.cells].map((c) => c.dataset.value || c.textContent)))")
        self.assertEqual(len(shown), 2)
        for table, band in zip(shown, sweep["bands"]):
            growth = next(row for row in table if "growth rate" in row[0])
            self.assertEqual([float(v) for v in growth[1:]], [max(side["rods"]["rod"]["growth_rate"]) for side in (band["at_from"], sweep, band["at_to"])])
            unstable = next(row for row in table if "unstable points" in row[0])
            self.assertEqual([int(v) for v in unstable[1:]], [side["verdict"].count("unstable") for side in (band["at_from"], sweep, band["at_to"])])

    def test_bands_of_a_system_of_equations_do_not_speak_of_links(self):
        self.browser.open(self.page("bands", scenes.FOLDER / "mathieu.toml", "--omega", "0.5:2.5:0.5", "--band", "damping=0.5:2", "--no-plots"))
        self.browser.settled()
        for name in ("shown-band", "sweep-bands"):
            self.assertIn("damping times 0.5 to 2", self.browser.text(name))
        self.assertNotIn("elastic link", self.browser.text("speeds"))
        self.assert_quiet()

    def test_what_linear_theory_leaves_out_of_the_growth_rate_stands_beside_it(self):
        steady = answer("steady", CRANK, "--rpm", 5000, "--modes", 3)
        self.browser.open(self.crank(), "#speed=8&play=0")
        self.browser.settled()
        cell = self.browser.run("return document.querySelector(\"#numbers [data-path='growth_theory_error']\").dataset.value")
        self.assertEqual(float(cell), steady["growth_theory_error"])
        low, high = self.browser.run("const along = report.along.rods.rod, a = theoryAround(rods[0], floats(along.growth_rate), doubles(report.along.x)); return [a.low[8], a.high[8]]")
        self.assertAlmostEqual(high - low, 2 * steady["growth_theory_error"], delta=1e-5 * abs(high))
        self.browser.run("[...document.querySelectorAll('#tables details')].forEach((d) => { d.open = true })")
        self.browser.settled()
        self.assertIn("growth rate of all: error of theory", self.browser.text("tables"))

    # Designs, and points without an answer

    def test_page_of_tune_has_both_designs_in_tables_curves_and_the_mechanism(self):
        arguments = ("tune", CRANK, "--minimise", "deflection", "--vary", "crank.length=35mm:45mm", "--keep", "stable", "--over", "rpm=1000:2000",
                     "--modes", 1)
        done = run(*arguments, "--out", self.folder / "tune", "--html", "--no-plots")
        self.assertEqual(done.returncode, 0, done.stderr)
        tune = json.loads((self.folder / "tune" / "tune.json").read_text())
        self.browser.open(self.folder / "tune" / "report.html", "#play=0")
        self.browser.settled()
        self.assertFalse(self.browser.run("return document.querySelector(\"nav a[href='#design']\").offsetParent === null"))
        cells = self.browser.run("return [...document.querySelector('#design table tbody tr').cells].map((c) => c.dataset.value || c.textContent)")
        variable = tune["variables"][0]
        self.assertEqual([float(cells[1]), float(cells[2])], [variable["before"], variable["after"]])
        self.assertGreaterEqual(self.browser.run("return document.querySelectorAll('#design canvas').length"), 2)
        for words in ("before", "after", "Conditions", "All that hb tune says"):
            self.assertIn(words, self.browser.text("design"))
        self.assertIn("Light: the design before", self.browser.text("mechanism-note"))
        self.assert_quiet()

    def test_points_where_the_mechanism_does_not_close_say_so_and_the_others_answer(self):
        arguments = ("sweep", scenes.FOLDER / "four_bar.toml", "--rpm", 300, "--x", "crank.length=0.1:0.3:0.05", "--modes", 1)
        done = run(*arguments, "--out", self.folder / "gap", "--html", "--no-plots")
        self.assertIn(done.returncode, (0, 3), done.stderr)
        sweep = answer(*arguments)
        self.browser.open(self.folder / "gap" / "report.html", "#play=0")
        self.assertIn("have no answer", self.browser.text("notes"))
        missing = [k for k, verdict in enumerate(sweep["verdict"]) if verdict is None]
        self.assertGreater(len(missing), 0)
        self.assertLess(len(missing), len(sweep["verdict"]))
        for index, verdict in enumerate(sweep["verdict"]):
            self.browser.choose(index)
            self.browser.settled()
            if verdict is None:
                self.assertIn("does not close", self.browser.text("numbers"))
                self.assertEqual(self.browser.text("verdict-coupler"), "–")
            else:
                self.assertEqual(self.browser.text("verdict-coupler"), sweep["rods"]["coupler"]["verdict"][index])
        self.assert_quiet()

    def test_page_of_stability_alone_and_page_of_a_map_alone_say_what_they_lack(self):
        done = run("sweep", CRANK, *self.SWEPT, "--only", "stability", "--out", self.folder / "stability", "--html")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.browser.open(self.folder / "stability" / "report.html", "#play=0")
        self.browser.settled()
        blank = self.browser.run("return [...document.querySelectorAll('.blank')].map((e) => e.dataset.view || e.dataset.chart)")
        self.assertEqual(sorted(blank), ["moment", "response", "response", "shape", "stress"])
        self.assertIn("not asked for", self.browser.text("speeds"))
        self.assert_quiet()
        done = run("map", scenes.FOLDER / "mathieu.toml", "--x", "omega=1.5:2.5:5", "--y", "hill.damping.0.0=0:0.2:3", "--out", self.folder / "map", "--html", "--no-plots")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.browser.open(self.folder / "map" / "report.html")
        self.browser.settled()
        self.assertIn("Without single speeds", self.browser.text("numbers"))
        self.assertIn("holds no sweep", self.browser.text("speeds"))
        self.assertGreater(self.browser.element("map").size["height"], 100)
        self.assert_quiet()

    # Hands and keys

    def test_cursors_of_the_charts_are_linked(self):
        from selenium.webdriver.common.action_chains import ActionChains
        self.browser.open(self.crank(), "#play=0")
        chart = self.browser.element("campbell-rod")
        self.browser.run("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", chart)
        self.browser.settled()
        ActionChains(self.browser.driver).move_to_element(chart).perform()
        self.browser.settled()
        rows = self.browser.run("return charts.map((c) => c.x[c.chart.getSelection()])")
        self.assertGreaterEqual(len(rows), 4)
        self.assertLessEqual(max(rows) - min(rows), 500)  # the nearest row of each
        told = self.browser.run("return document.querySelector('#campbell-rod .dygraph-legend').textContent")
        self.assertIn("mode 1", told)

    def test_zoom_of_one_chart_is_that_of_all_and_goes_into_the_address(self):
        self.browser.open(self.crank(), "#play=0&zoom=2000:4000")
        self.browser.settled()
        windows = self.browser.run("return charts.map((c) => c.chart.xAxisRange())")
        for low, high in windows:
            self.assertAlmostEqual(low, 2000, delta=30)
            self.assertAlmostEqual(high, 4000, delta=30)

    def test_map_is_reached_and_moved_by_keys_alone(self):
        from selenium.webdriver.common.keys import Keys
        self.browser.open(self.crank(), "#speed=0&play=0")
        self.browser.settled()
        self.focus("map")
        before = self.browser.run("return state.mapNode")
        self.press(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT, Keys.ARROW_UP)
        self.browser.settled()
        after = self.browser.run("return state.mapNode")
        self.assertEqual(after, [before[0] + 2, min(2, before[1] + 1)])
        self.assertEqual(self.browser.text("rpm-value"), "3000.0")
        self.assertIn("rod.section.height", self.browser.run("return document.querySelector('.map-reading').textContent"))

    def test_every_control_is_reached_by_the_tab_key_and_has_a_name(self):
        from selenium.webdriver.common.keys import Keys
        self.browser.open(self.crank(), "#play=0")
        self.browser.settled()
        reached = []
        for _ in range(60):
            self.press(Keys.TAB)
            one = self.browser.run("""
                const e = document.activeElement, label = e.closest("label");
                return [e.id || e.tagName + ":" + (e.textContent || "").slice(0, 30), e.getAttribute("aria-label") || (label && label.textContent.trim()) || e.textContent.trim() || e.title]""")
            if one[0] in [name for name, _ in reached]:
                break
            reached.append(one)
        names = [name for name, _ in reached]
        for wanted in ("speed", "speed-down", "speed-up", "play", "angle", "magnification", "pace", "shown-band", "map", "scene-table"):
            self.assertIn(wanted, names)
        self.assertEqual([name for name, words in reached if not words and name != "scene-table"], [])

    def test_keys_step_the_speed_and_play_from_anywhere_on_the_page(self):
        from selenium.webdriver.common.keys import Keys
        self.browser.open(self.crank(), "#speed=3&play=0")
        self.browser.settled()
        self.browser.run("document.activeElement.blur()")
        self.press(Keys.ARROW_RIGHT)
        self.assertEqual(self.browser.text("rpm-value"), "3000.0")
        self.press(Keys.SPACE)
        self.assertTrue(self.browser.run("return state.playing"))
        self.press(Keys.SPACE)
        self.assertFalse(self.browser.run("return state.playing"))

    def test_numbers_follow_a_held_slider_and_are_whole_when_it_is_let_go(self):
        self.browser.open(self.crank(), "#play=0")
        self.browser.settled()
        hand = "document.getElementById('speed').dispatchEvent(new PointerEvent(arguments[0], {bubbles: true}))"
        torque = "const c = document.querySelector(\"#numbers [data-path='torque.max']\"); return c && Number(c.dataset.value)"
        growth = "return Number(document.querySelector(\"#numbers [data-path='rods.rod.growth_rate']\").dataset.value)"
        before = self.browser.run(torque), self.browser.run(growth)
        self.browser.run(hand, "pointerdown")
        for index in range(1, 9):
            self.browser.choose(index)
        steady = answer("steady", CRANK, "--rpm", 5000, "--modes", 3)
        self.assertEqual(self.browser.run(growth), steady["rods"]["rod"]["growth_rate"])
        self.browser.run(hand, "pointerup")
        self.assertEqual(self.browser.run(torque), steady["torque"]["max"])
        self.assertNotEqual(before, (self.browser.run(torque), self.browser.run(growth)))
        self.assertEqual(len(self.browser.run("return [...document.querySelectorAll('#numbers details')].filter((d) => d.open)")), 0)

    def test_address_carries_all_that_was_chosen(self):
        self.browser.open(self.crank(), "#play=0")
        self.browser.choose(5)
        self.browser.run("""
            const choose = (name, value) => { const e = document.getElementById(name); e.value = value; for (const kind of ["input", "change"]) e.dispatchEvent(new Event(kind, {bubbles: true})); };
            choose("angle", "77");
            choose("magnification", [...document.getElementById("magnification").options].at(-1).value);
            choose("pace", [...document.getElementById("pace").options].at(-1).value);
            const joint = document.querySelector("#forces select"); joint.value = "piston.guide"; joint.dispatchEvent(new Event("change"));
            choose("shown-band", "1");
            const fibre = document.querySelector("[data-view=stress] ~ .toolbar select"); fibre.value = "-1"; fibre.dispatchEvent(new Event("change"));""")
        from selenium.webdriver.common.keys import Keys
        own = self.browser.run("return state.mapNode[1]")
        self.focus("map")
        self.press(Keys.ARROW_DOWN)
        self.browser.driver.execute_async_script("setTimeout(arguments[0], 500)")
        wanted = "const s = state; return [s.index, Math.round(s.angle * 180 / Math.PI), s.magnification, s.secondsPerTurn, s.joint, s.mapNode, s.band, s.fibre, location.hash]"
        before = self.browser.run(wanted)
        self.assertEqual(before[:2] + before[4:5], [5, 77, "piston.guide"])
        self.assertEqual(before[6:8], [1, -1])
        self.assertNotEqual(before[5][1], own, "the map's place lies off the scene's own height")
        self.browser.open(self.crank(), before[-1])
        self.browser.settled()
        self.assertEqual(self.browser.run(wanted)[:-1], before[:-1])
        self.browser.run("document.querySelector(\"nav a[href='#tables']\").click()")
        self.browser.driver.execute_async_script("setTimeout(arguments[0], 500)")
        self.assertEqual(self.browser.run("return location.hash"), before[-1])
        self.browser.run("location.hash = '#speed=2&play=0'")
        self.browser.driver.execute_async_script("setTimeout(arguments[0], 1000)")
        self.browser.settled()
        self.assertEqual(self.browser.text("rpm-value"), "2000.0")
        self.browser.open(self.crank(), "#speed=1e9&angle=x&zoom=9:1&map=77:-3&joint=<b>&magnification=-1&pace=NaN&play=7&band=99&fibre=x")
        self.browser.settled()
        self.assertEqual(self.browser.text("rpm-value"), "7000.0")
        self.assert_quiet()

    # Phones, paper, and readers without script

    def test_narrow_screen_needs_no_sideways_scrolling_with_bands_and_stress(self):
        self.browser.resize(360, 800)
        try:
            self.browser.open(self.crank(), "#play=0")
            self.browser.settled()
            self.assertLessEqual(self.browser.run("return document.documentElement.scrollWidth"), 360)
        finally:
            self.browser.resize(1300, 900)

    def test_prints_every_part_without_controls(self):
        self.browser.open(self.crank(), "#play=0")
        self.browser.settled()
        paper = base64.b64decode(self.browser.driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})["data"])
        self.assertTrue(paper.startswith(b"%PDF"))
        self.assertGreaterEqual(paper.count(b"/Type /Page\n") + paper.count(b"/Type/Page\n"), 4)
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        try:
            shown = self.browser.run("return ['speed', 'play', 'speed-up', 'mechanism', 'campbell-rod', 'map', 'tables', 'scene'].map((n) => document.getElementById(n).getClientRects().length > 0)")
        finally:
            self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        self.assertEqual(shown, [False, False, False, True, True, True, True, True])
        self.assert_quiet()

    @unittest.skipUnless(shutil.which("gnuplot"), "gnuplot is missing")
    def test_readers_without_script_see_the_pictures_of_the_commands(self):
        page = self.page("still", scenes.FOLDER / "four_bar.toml", "--rpm", "100:300:100", "--modes", "1")
        command = self.browser.driver.execute_cdp_cmd
        command("Emulation.setScriptExecutionDisabled", {"value": True})
        try:
            self.browser.driver.get(page.as_uri())
            shown = command("Runtime.evaluate", {"returnByValue": True, "expression":
                "[...document.querySelectorAll('noscript img')].map((i) => [i.naturalWidth, i.getClientRects().length, i.alt.length])"})["result"]["value"]
        finally:
            command("Emulation.setScriptExecutionDisabled", {"value": False})
        self.assertGreaterEqual(len(shown), 5)
        for width, drawn, words in shown:
            self.assertGreater(width, 300)
            self.assertEqual(drawn, 1)
            self.assertGreater(words, 5)


if __name__ == "__main__":
    pages.main()
