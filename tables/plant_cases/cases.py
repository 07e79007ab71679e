"""The hard cases of the plant: what tests/plant_cases/ asserts and what docs/plant-hard-cases.md
prints."""

from device_cases import DEVICE, DRIVE, ENCODER, HAND
from plant_case import Case
from wall_cases import STIFFNESS, TIME

GROUPS: dict[str, tuple[Case, ...]] = {
    "Stiffness and damping of the wall": STIFFNESS,
    "Time": TIME,
    "Converter, amplifier, motor": DRIVE,
    "Encoder": ENCODER,
    "Hand": HAND,
    "Device": DEVICE,
}
