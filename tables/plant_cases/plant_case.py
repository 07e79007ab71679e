"""What a hard case of the plant is. A setting is what `hvp run --set` takes."""

from dataclasses import dataclass

# What every case starts from: a device of 0.1 kg and 1 N s/m in a hand of 375 N/m and 4.5 N s/m
# (Speich et al. 2005) that presses 5 mm deep into a wall within half a second, and then rests.
SCENE = """\
title = "A hard case of the plant"
frames = 1500
[wall]
stiffness = "500 N/m"
[device.dynamics]
mass = "100 g"
damping = "1 N s/m"
[hand]
[probe]
start = ["0 mm", "0 mm", "5 mm"]
[[probe.motion]]
phase = "press"
to = ["0 mm", "0 mm", "-5 mm"]
duration = "0.5 s"
[device.daq]
sampling_delay = "0 s"
output_delay = "0 s"
[fidelity]
bus = "untimed"
host = "untimed"
[output]
pictures = false
"""

CYCLE = "limit-cycle"
ACTIVE = "active-port"
SATURATED = "force-saturated"
LIMIT = "device-at-its-limit"
CLAMPED = "force-clamped"
MARGIN = "low-gain-margin"
STEP = "force-step"


@dataclass(frozen=True)
class Remedy:
    settings: tuple[str, ...]
    left: frozenset[str] = frozenset()  # flags that it leaves


@dataclass(frozen=True)
class Case:
    name: str
    expected: str  # a sentence without its full stop
    settings: tuple[str, ...] = ()
    flags: frozenset[str] = frozenset()
    # Each is tried by itself, in this order. Where there are some, one at least leaves no flag and
    # a device at rest.
    remedies: tuple[Remedy, ...] = ()
    refused: bool = False  # by a message, before anything runs


def up(*flags: str) -> frozenset[str]:
    return frozenset(flags)


def fix(*settings: str, left: frozenset[str] = frozenset()) -> Remedy:
    return Remedy(settings, left)
