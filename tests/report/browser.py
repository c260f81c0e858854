"""Headless Chromium on one page at a time, and what it did: console, requests."""

import json
import pathlib
import shutil

MISSING = 77  # exit status that CTest takes for "skipped"


def missing_parts():
    """What this machine lacks for the tests, in words; empty: nothing."""
    parts = []
    try:
        import selenium  # noqa: F401
    except ImportError:
        parts.append("python3-selenium")
    for program, package in (("chromium", "chromium"), ("chromedriver", "chromium-driver")):
        if shutil.which(program) is None:
            parts.append(package)
    return parts


class Browser:
    def __init__(self, width=1300, height=900):
        from selenium import webdriver
        from selenium.webdriver.chrome.options import Options
        from selenium.webdriver.chrome.service import Service

        options = Options()
        for flag in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                     f"--window-size={width},{height}", "--force-device-scale-factor=1"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
        self.resize(width, height)

    def close(self):
        self.driver.quit()

    def resize(self, width, height):
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600})

    def dark(self, on):
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": "dark" if on else "light"}]})

    def open(self, page, fragment=""):
        self.console(), self.requests()  # of pages before
        self.driver.get("about:blank")
        self.driver.get(pathlib.Path(page).as_uri() + fragment)

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def element(self, name):
        """By id; None where there is none."""
        return self.run("return document.getElementById(arguments[0])", name)

    def text(self, name):
        return self.run("return document.getElementById(arguments[0]).textContent", name)

    def choose(self, index):
        """The slider to an index, as a hand would: its value, then its event."""
        self.run("const s = document.getElementById('speed'); s.value = arguments[0];"
                 "s.dispatchEvent(new Event('input', {bubbles: true}))", index)

    def settled(self):
        """After everything asked for has been drawn."""
        self.driver.execute_async_script("const done = arguments[0];"
                                         "requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 0)))")

    def console(self):
        """Errors and warnings since the last call."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def requests(self):
        """Addresses asked for since the last call, data in the page itself left out."""
        found = []
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] in ("Network.requestWillBeSent", "Network.webSocketCreated"):
                url = message["params"].get("request", message["params"])["url"]
                if not url.startswith(("data:", "about:")):
                    found.append(url)
        return found
