"""How long a page of hb report takes to follow its slider: python3 report_drag.py PAGE...

A row for each page and part of it in sight: the page's size, its speeds and places of the map; then, for one step of
the slider with everything in sight drawn anew, milliseconds of processor time of the page's thread (script, style, layout, painting: what other programs take does not
count), of it those of script, and milliseconds of script by the clock (median, 95 of 100).
Headless Chromium without a graphics card; Debian: chromium, chromium-driver, python3-selenium."""

import pathlib
import platform
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "tests" / "report"))

import browser  # noqa: E402

# A drag to and fro over all speeds, a step for every frame. What a frame draws runs inside flush(): here at once.
DRAG = """
const [count, done] = arguments, times = [];
const hand = (kind) => slider.dispatchEvent(new PointerEvent(kind, {bubbles: true}));
hand("pointerdown");
const drag = (k) => () => {
  const start = performance.now();
  slider.value = String(Math.round((points.count - 1) * 0.5 * (1 - Math.cos(0.13 * k))));
  slider.dispatchEvent(new Event("input", {bubbles: true}));
  flush();
  times.push(performance.now() - start);
  if (k + 1 < count) requestAnimationFrame(drag(k + 1)); else requestAnimationFrame(() => setTimeout(() => { hand("pointerup"); done(times); }, 0));
};
requestAnimationFrame(drag(0));
"""
STEPS = 150
PARTS = ("mechanism-section", "rods", "forces", "speeds", "map-section")


def at_share(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def busy(window):
    """Seconds of processor time of the page's thread so far: all of it, and of script."""
    metrics = {m["name"]: m["value"] for m in window.driver.execute_cdp_cmd("Performance.getMetrics", {})["metrics"]}
    return [metrics["TaskDuration"], metrics["ScriptDuration"]]


def main():
    window = browser.Browser(1280, 900)
    try:
        window.driver.execute_cdp_cmd("Performance.enable", {"timeDomain": "threadTicks"})
        version = window.driver.capabilities["browserVersion"]
        cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), platform.machine())
        print(f"# {cpu}, Chromium {version} headless, window 1280 x 900, {STEPS} steps")
        print("page,bytes,speeds,map places,in sight,processor [ms],of it script [ms],script by the clock [ms],95 % of it [ms]")
        for page in map(pathlib.Path, sys.argv[1:]):
            window.open(page.resolve(), "#play=0")
            window.settled()
            speeds, places = window.run("return [points.count, report.map ? report.map.x.values.length * report.map.y.values.length : 0]")
            for part in PARTS:
                window.run("document.getElementById(arguments[0]).scrollIntoView({behavior: 'instant'})", part)
                window.settled()
                window.driver.execute_async_script(DRAG, 20)  # warms up
                before = busy(window)
                script = window.driver.execute_async_script(DRAG, STEPS)
                whole, own = (1000 * (after - since) / STEPS for after, since in zip(busy(window), before))
                print(f"{page.name},{page.stat().st_size},{speeds},{places},{part},{whole:.2f},{own:.2f},{at_share(script, 0.5):.2f},{at_share(script, 0.95):.2f}", flush=True)
    finally:
        window.close()


main()
