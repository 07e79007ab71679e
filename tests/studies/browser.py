"""A real browser for the tests of pages, without a network."""

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait


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

    def media(self, kind: str, scheme: str) -> None:
        """As which medium and in which colours pages are shown."""
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.driver.execute_cdp_cmd(
            "Emulation.setEmulatedMedia", {"media": kind, "features": features}
        )

    def complaints(self) -> list[str]:
        """What the console says that is worse than a note; advice on a renderer's speed is one."""
        return [
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
    try:
        yield Browser(chrome)
    finally:
        chrome.quit()
