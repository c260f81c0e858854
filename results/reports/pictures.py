"""Pictures of pages as headless Chromium shows them: python3 pictures.py PAGE FRAGMENT SECTION OUT.png ...

A page with the address's FRAGMENT (what is shown: speed, crank angle, ...), from the element SECTION (a CSS selector) on or,
with -, from its top; a picture for each four arguments. Debian: chromium, chromium-driver, python3-selenium."""

import base64
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent.parent / "tests" / "report"))

import browser  # noqa: E402

WIDTH, HEIGHT = 1180, 780


def main():
    window = browser.Browser(WIDTH, HEIGHT)
    try:
        for page, fragment, section, out in zip(*[iter(sys.argv[1:])] * 4):
            # High enough for all views to be drawn.
            window.resize(WIDTH, 6000)
            window.open(pathlib.Path(page).resolve(), fragment)
            window.settled()
            # The bar with the speed stays at the window's top.
            window.run("document.getElementById('controls').style.position = 'static'")
            window.settled()
            top = window.run("const e = arguments[0] === '-' ? null : document.querySelector(arguments[0]);"
                             "return e ? e.getBoundingClientRect().top + window.scrollY : 0", section)
            shot = window.driver.execute_cdp_cmd("Page.captureScreenshot", {
                "captureBeyondViewport": True, "clip": {"x": 0, "y": top, "width": WIDTH, "height": HEIGHT, "scale": 1}})
            pathlib.Path(out).write_bytes(base64.b64decode(shot["data"]))
            if window.console():
                sys.exit(f"{page}: {window.console()}")
    finally:
        window.close()


main()
