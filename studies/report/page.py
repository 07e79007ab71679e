"""A page as one file: template, style, scripts and plotly.js, without a network and without a date.

What is in a page follows from what it is made of alone, so equal results give equal bytes.
"""

import base64
import gzip
import json
import math
import re
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from studies.text_table import cell

_TEMPLATES = Path(__file__).parent / "templates"
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")


def render(template: str, data: dict[str, Any], **values: Any) -> str:
    """A page. `data` is what its scripts see, as JSON; every other value is escaped."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(
        style=_asset("style.css"),
        scripts=[_asset("page.js"), _asset("print.js")],
        plotly=_plotly(),
        data=_embedded(data),
        plain=plain,
        number=number,
        **values,
    )


def plain(text: str) -> str:
    """A line of the reference without its Markdown: links point into docs/, which is not here."""
    return _LINK.sub(r"\1", text).replace("`", "")


def number(value: Any, digits: int = 6) -> str:
    """A value for a reader."""
    return cell(None if isinstance(value, float) and math.isnan(value) else value, digits)


def _embedded(data: dict[str, Any]) -> Markup:
    """JSON that no word in it can end: the escapes are JSON's own."""
    text = json.dumps(data, sort_keys=True, allow_nan=False, ensure_ascii=True)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _asset(name: str) -> Markup:
    return Markup((_TEMPLATES / name).read_text(encoding="utf-8"))


@cache
def _plotly() -> Markup:
    """plotly.js, compressed: 2 MB in place of 4.8. The time in gzip's header is zero."""
    script = resources.files("plotly").joinpath("package_data/plotly.min.js").read_bytes()
    packed = gzip.compress(script, compresslevel=9, mtime=0)
    return Markup(base64.b64encode(packed).decode("ascii"))
