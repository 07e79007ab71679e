"""How large an FPGA is, by its table in devices/: what a search takes for its cost.

Nobody publishes prices that last; the counts of a device's table do.
"""

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from studies.program import Figure

_DEVICES = Path(__file__).resolve().parents[1] / "devices"

FIGURES = {
    name: Figure(name, unit, text)
    for name, unit, text in (
        ("device.logic_cells", "", "look-up tables of the device"),
        ("device.multipliers", "", "multipliers of the device, in its first mode"),
        ("device.memory_bits", "bit", "bits of all memory blocks of the device, without parity"),
    )
}


@cache
def size(name: str, scenario: Path) -> dict[str, float]:
    """The figures of a device by its name, or by a file beside the scenario; nothing if unknown."""
    path = scenario.parent / name if name.endswith(".toml") else _DEVICES / f"{name}.toml"
    try:
        device: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        return {
            "device.logic_cells": device["logic"]["cells"],
            "device.multipliers": device["multiplier"][0]["count"],
            "device.memory_bits": sum(m["blocks"] * m["bits"] for m in device["memory"]),
        }
    except (OSError, ValueError, KeyError):
        return {}
