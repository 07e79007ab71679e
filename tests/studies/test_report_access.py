"""Pages for those who have no mouse, no screen, or a printer: keys, what is read out, paper."""

import base64
import itertools
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from browser import Browser
from pages import write_study_page
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

# A page of A4 between margins of 15 mm.
PAPER_PX = 680
FOCUSED = """
    const it = document.activeElement, style = getComputedStyle(it);
    const box = it.getBoundingClientRect();
    return { name: it.id || it.textContent.trim() || it.getAttribute("data-title"),
      tag: it.tagName, plot: it.closest(".plot")?.id,
      ring: style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 1,
      seen: box.width > 0 && box.top < innerHeight && box.bottom > 0 };
"""
# Every control that the page shows, in the order of its document.
CONTROLS = """
    const kinds = "a[href], button, input, select, summary, pre[tabindex], .plot";
    return [...document.querySelectorAll(kinds)]
      .filter((it) => it.checkVisibility())
      .map((it) => it.id || it.textContent.trim() || it.getAttribute("data-title"));
"""
# What is drawn beyond the paper's edge, but for what a plot itself clips.
BEYOND = """
    return [...document.querySelectorAll("body *")]
      .filter((it) => it.checkVisibility() && !it.parentElement.closest(".plot"))
      .filter((it) => it.getBoundingClientRect().right > arguments[0] + 1
        || (it.scrollWidth > it.clientWidth + 1 && getComputedStyle(it).overflowX !== "visible"))
      .map((it) => it.tagName + " " + it.className + ": " + it.textContent.slice(0, 60));
"""
# Of every piece of text with its ground, by the formula of WCAG 2.2.
CONTRASTS = r"""
    const linear = (part) => part <= 0.04045 ? part / 12.92 : ((part + .055) / 1.055) ** 2.4;
    const bright = (colour) => {
      const [r, g, b] = colour.match(/[0-9.]+/g).map((part) => linear(part / 255));
      return .2126 * r + .7152 * g + .0722 * b;
    };
    const ground = (it) => {
      const colour = getComputedStyle(it).backgroundColor;
      return /, 0[)]$/.test(colour) ? ground(it.parentElement) : colour;
    };
    const has_text = (it) =>
      [...it.childNodes].some((node) => node.nodeType === 3 && node.data.trim());
    return [...document.querySelectorAll("body *")]
      .filter((it) => it.checkVisibility() && !it.closest(".plot, script") && has_text(it))
      .map((it) => [bright(getComputedStyle(it).color), bright(ground(it))].sort((a, b) => a - b))
      .map(([dark, light]) => (light + .05) / (dark + .05));
"""
SHOWN_CONTROLS = """
    return [...document.querySelectorAll("nav, button, input, select, summary, .modebar")]
      .filter((it) => it.checkVisibility()).map((it) => it.outerHTML.slice(0, 80));
"""
WIDTHS = (
    "[...document.querySelectorAll('.plot')]"
    ".map((plot) => plot.querySelector('svg.main-svg').getBoundingClientRect().width)"
)
ROWS = (
    "return [...document.querySelectorAll('#rows tbody tr')].filter(r => !r.hidden)"
    ".map(r => r.cells[0].textContent)"
)


def walk(browser: Browser) -> list[dict[str, Any]]:
    """What Tab comes to, until it leaves the page."""
    browser.run("document.body.tabIndex = -1; document.body.focus(); scrollTo(0, 0)")
    met: list[dict[str, Any]] = []
    for _ in range(200):
        browser.press(Keys.TAB)
        it = browser.run(FOCUSED)
        if it["tag"] == "BODY" or (met and it["name"] == met[0]["name"]):
            return met
        met.append(it)
    raise AssertionError("Tab goes round in a part of the page")


def walk_all(browser: Browser) -> list[str]:
    """The names of what Tab comes to: every control, in the page's order, each seen to have it."""
    met = walk(browser)
    controls = browser.run(CONTROLS)
    names = [it["name"] for it in met]
    assert len(controls) > 10
    assert [name for name in names if name in set(controls)] == controls
    assert [it for it in met if not it["ring"] or not it["seen"]] == []
    return names


def test_a_table_is_sorted_and_filtered_by_keys_alone(browser: Browser, study_page: Path) -> None:
    browser.open(study_page)
    names = walk_all(browser)
    browser.run("document.body.focus()")
    browser.press(*[Keys.TAB] * (names.index("rows-filter") + 1), "not held")
    # A message holds neither word, so one row is left of the five.
    assert browser.run(ROWS) == ["40"]
    browser.press(*[Keys.BACKSPACE] * len("not held"), Keys.TAB, "r")
    assert browser.run("return document.activeElement.value") == "refused"
    assert browser.run(ROWS) == ["80"]
    browser.press(Keys.HOME)
    assert browser.run(ROWS) == ["5", "10", "20", "40", "80"]
    forward = names.index("deadline.worst_us / µs") - names.index("rows-status")
    browser.press(*[Keys.TAB] * forward, Keys.SPACE)
    assert browser.run(ROWS) == ["20", "5", "10", "40", "80"]
    browser.press(Keys.SPACE)
    assert browser.run(ROWS) == ["40", "10", "5", "20", "80"]


def test_a_run_is_walked_and_its_body_stepped_and_turned_by_keys(
    browser: Browser, run_page: Path
) -> None:
    browser.open(run_page)
    assert {"step", "body-plot", "frames-plot", "Worst frame"} <= set(walk_all(browser))
    heights = "return Array.from(document.getElementById('body-plot').data[0].z)"
    says = "return document.getElementById('step-says').textContent"
    browser.run("document.getElementById('step').focus()")
    browser.press(Keys.HOME)
    first, at_first = browser.run(heights), browser.run(says)
    assert at_first.startswith("frame 0,")
    browser.press(Keys.END, Keys.ARROW_LEFT)
    assert browser.run(heights) != first
    assert browser.run(says) != at_first
    spoken = "return document.getElementById('step').getAttribute('aria-valuetext')"
    assert browser.run(spoken) == browser.run(says)
    steps = browser.run("return Number(document.getElementById('step').max)")
    assert browser.run("return Number(document.getElementById('step').value)") == steps - 1
    browser.press(Keys.ARROW_RIGHT)
    assert browser.run("return Number(document.getElementById('step').value)") == steps

    eye = """const { scene } = document.getElementById('body-plot')._fullLayout;
        const { x, y, z } = scene._scene.getCamera().eye;
        return [x, y, z]"""
    before = browser.run(eye)
    browser.run("document.getElementById('body-plot').focus()")
    browser.press(Keys.ARROW_RIGHT)
    turned = browser.run(eye)
    assert turned[2] == pytest.approx(before[2])
    assert turned[:2] != pytest.approx(before[:2])
    browser.press(Keys.ARROW_UP)
    assert browser.run(eye)[2] > turned[2]
    browser.press("+")
    assert sum(part**2 for part in browser.run(eye)) < sum(part**2 for part in before)
    browser.press("0")
    assert browser.run(eye) == pytest.approx(before)


@pytest.mark.parametrize("kind", ["run_page", "study_page"])
def test_what_a_screen_reader_is_told(
    browser: Browser, request: pytest.FixtureRequest, kind: str
) -> None:
    browser.open(request.getfixturevalue(kind))
    browser.run("for (const part of document.querySelectorAll('details')) part.open = true")
    tree = browser.tree()
    roles = [role for role, _ in tree]
    for landmark in ("banner", "main", "contentinfo", "navigation"):
        assert roles.count(landmark) == 1
    named = {
        *("button", "link", "searchbox", "combobox", "slider", "table", "region", "navigation"),
        *("heading", "image", "toolbar", "columnheader", "rowheader"),
    }
    assert [role for role, name in tree if role in named and not name] == []
    assert not {"SvgRoot", "graphics-symbol", "Canvas"} & set(roles)
    # Two groups of equal name could not be told apart.
    groups = [
        name for role, name in tree if role in ("group", "region", "toolbar", "table") if name
    ]
    assert sorted(set(groups)) == sorted(groups)
    headings = browser.run(
        "return [...document.querySelectorAll('h1, h2, h3')].map(h => Number(h.tagName[1]))"
    )
    assert headings[0] == 1 and headings.count(1) == 1
    assert all(b - a <= 1 for a, b in itertools.pairwise(headings))
    plots = browser.run("return document.querySelectorAll('.plot').length")
    says = [name for role, name in tree if role == "group" and len(name) > 40]
    assert len(says) == plots


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_stand_out_from_their_ground(browser: Browser, study_page: Path, scheme: str) -> None:
    browser.open(study_page, scheme)
    ratios = browser.run(CONTRASTS)
    # Web Content Accessibility Guidelines 2.2, 1.4.3: 4.5 for text of this size.
    assert len(ratios) > 20
    assert min(ratios) >= 4.5


def test_paper_has_all_of_a_run_and_no_control(browser: Browser, run_page: Path) -> None:
    browser.open(run_page, "dark")
    folded = "return document.querySelectorAll('details:not([open])').length"
    assert browser.run(folded) == 3
    browser.media("print", "dark")
    browser.width(PAPER_PX)
    try:
        browser.run("dispatchEvent(new Event('beforeprint'))")
        assert browser.run(BEYOND, PAPER_PX) == []
        assert browser.run(SHOWN_CONTROLS) == []
        assert browser.run(folded) == 0
        colours = "return [getComputedStyle(document.body).backgroundColor, "
        colours += "document.getElementById('frames-plot').layout.paper_bgcolor]"
        assert browser.run(colours) == ["rgb(255, 255, 255)", "#fff"]
        browser.run("dispatchEvent(new Event('afterprint'))")
        assert browser.run(folded) == 3
    finally:
        browser.width(None)
    # What a printer makes of it is made between the same two events.
    browser.media("", "dark")
    browser.run(f"addEventListener('beforeprint', () => {{ window.printed = {WIDTHS} }})")
    made = browser.driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})
    assert base64.b64decode(made["data"]).startswith(b"%PDF")
    widths = browser.run("return window.printed")
    assert len(widths) == 3
    assert max(widths) <= PAPER_PX
    assert browser.run(colours)[1] == "#14171b"
    WebDriverWait(browser.driver, 20).until(
        lambda _: min(browser.run(f"return {WIDTHS}")) > PAPER_PX
    )


def test_a_wide_table_is_printed_in_strips(browser: Browser, tmp_path: Path) -> None:
    frame = pd.DataFrame({f"figure.{column}": [column, column + 0.5] for column in range(20)})
    frame["solver.method"] = "cg"
    frame["deadline.worst_us"] = [100.0, 101.0]
    frame["accuracy.displacement_of_frame.p95"] = [0.1, 0.01]
    frame["message"] = ["", "a line that goes on for longer than a column of figures is wide"]
    page = write_study_page(tmp_path, frame)
    browser.open(page)
    browser.media("print", "light")
    browser.width(PAPER_PX)
    try:
        browser.run("dispatchEvent(new Event('beforeprint'))")
        assert browser.run(BEYOND, PAPER_PX) == []
        paper = browser.run("return document.querySelector('main').innerText")
        for column in frame.columns:
            for value in frame[column]:
                assert (value if isinstance(value, str) else f"{value:g}") in paper
            assert column in paper
        heads = browser.run(
            "return [...document.querySelectorAll('.strip')]"
            ".map(t => t.tHead.rows[0].cells[0].textContent)"
        )
        assert heads == ["figure.0"] * 4 + ["column"]
        browser.run("dispatchEvent(new Event('afterprint'))")
        assert browser.driver.find_elements(By.CLASS_NAME, "strip") == []
    finally:
        browser.width(None)
