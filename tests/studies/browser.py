"""A real browser for the tests of pages, without a network."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.support.ui import WebDriverWait

# plotly.js warns by console.trace, which no log of the driver has.
_KEEP_TRACES = """
    window.traced = [];
    console.trace = (...words) => window.traced.push(words.join(" "));
"""


class Browser:
    """One headless Chromium."""

    def __init__(self, driver: webdriver.Chrome) -> None:
        self.driver = driver

    def log(self, kind: str) -> list[dict[str, Any]]:
        """What was logged since it was asked for last."""
        entries: list[dict[str, Any]] = self.driver.get_log(kind)  # type: ignore[no-untyped-call]
        return entries

    def open(self, page: Path, scheme: str = "light") -> None:
        """Load a page until its plots are drawn."""
        self.media("screen", scheme)
        self.log("browser")
        self.log("performance")
        self.driver.get(page.resolve().as_uri())
        WebDriverWait(self.driver, 30).until(
            lambda _: self.run("return document.documentElement.dataset.ready") is not None
        )

    def run(self, script: str, *arguments: Any) -> Any:
        """What a script returns."""
        return self.driver.execute_script(script, *arguments)

    def tree(self) -> list[tuple[str, str]]:
        """Role and name of everything that a screen reader is told of, in its order."""
        nodes = self.driver.execute_cdp_cmd("Accessibility.getFullAXTree", {})["nodes"]
        return [
            (node["role"]["value"], node.get("name", {}).get("value", "").strip())
            for node in nodes
            if not node["ignored"]
        ]

    def press(self, *keys: str) -> None:
        """Keys, for what has the focus."""
        ActionChains(self.driver).send_keys(*keys).perform()

    def width(self, px: int | None) -> None:
        """Of the page; None for the window's."""
        if px is None:
            self.driver.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
            return
        size = {"width": px, "height": 1000, "deviceScaleFactor": 0, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)

    def media(self, kind: str, scheme: str) -> None:
        """As which medium and in which colours pages are shown."""
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.driver.execute_cdp_cmd(
            "Emulation.setEmulatedMedia", {"media": kind, "features": features}
        )

    def complaints(self) -> list[str]:
        """What the console says that is worse than a note; advice on a renderer's speed is one."""
        traced: list[str] = self.run("return window.traced")
        return traced + [
            entry["message"]
            for entry in self.log("browser")
            if entry["level"] in ("SEVERE", "WARNING") and entry["source"] != "rendering"
        ]

    def requests(self) -> list[str]:
        """Every address that was asked for, but the page itself and what it has in memory."""
        events = [json.loads(entry["message"])["message"] for entry in self.log("performance")]
        addresses = [
            event["params"]["request"]["url"]
            for event in events
            if event["method"] == "Network.requestWillBeSent"
        ]
        return [address for address in addresses[1:] if not address.startswith(("blob:", "data:"))]


def start() -> Iterator[Browser]:
    """A browser, ended afterwards; a test that wants one is skipped where there is none."""
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if chromium is None or driver is None:
        pytest.skip("no chromium or no chromedriver (Debian: chromium, chromium-driver)")
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--host-resolver-rules=MAP * ~NOTFOUND",
        "--window-size=1200,1000",
    ):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    chrome = webdriver.Chrome(options=options, service=Service(driver))
    chrome.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": _KEEP_TRACES})
    try:
        yield Browser(chrome)
    finally:
        chrome.quit()
