# SPDX-License-Identifier: Apache-2.0
"""The settings of a solve: struct hvp_solver_config."""

from __future__ import annotations

import struct
from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any

from hvp_board._driver import ffi


class Method(IntEnum):
    """How the board solves (docs/fixed-point.md)."""

    CG = 0
    JACOBI_PCG = 1
    BLOCK_JACOBI_PCG = 2
    CHRONOPOULOS_GEAR = 3
    PIPELINED_CG = 4


class StartFrom(IntEnum):
    """Where a job begins."""

    ZERO = 0
    LAST = 1
    EXTRAPOLATED = 2


class Rounding(IntEnum):
    """What becomes of the bits that are dropped."""

    NEAREST_UP = 0
    NEAREST_EVEN = 1
    TRUNCATION = 2


@dataclass(frozen=True, kw_only=True)
class Settings:
    """As docs/driver.md has them; what is left out is zero there. `stop_residual` is t of
    |r| <= t·|b|, from 0 to 1; 0: the count of iterations alone."""

    iterations: int
    matrix_bits: int
    vector_bits: int
    coefficient_bits: int = 16
    method: Method = Method.CG
    start: StartFrom = StartFrom.ZERO
    stop_residual: float = 0.0
    replace_every: int = 0
    static_shift: int = 0
    dynamic_scaling: bool = False
    scaling_up_only: bool = False
    headroom_bits: int = 0
    scaling_threshold: int = 0
    scaling_step: int = 0
    rhs_bits: int = 0
    scalar_bits: int = 0
    fixed_coefficients: bool = False
    alpha_fraction: int = 0
    beta_fraction: int = 0
    division_rounding: Rounding = Rounding.NEAREST_UP
    shift_rounding: Rounding = Rounding.NEAREST_UP
    one_a_word: bool = False
    wrap_overflow: bool = False
    reject_saturated: bool = False

    def to_c(self) -> Any:
        config = ffi.new("struct hvp_solver_config*")
        for field in fields(self):
            setattr(config, field.name, self._to_c(field.name))
        return config

    def _to_c(self, name: str) -> int:
        # The register holds the bits of the double.
        return bits_of(self.stop_residual) if name == "stop_residual" else getattr(self, name)

    def __post_init__(self) -> None:
        if self.stop_residual != 0.0 and not 2.0**-511 <= self.stop_residual <= 1.0:
            raise ValueError(f"stop_residual {self.stop_residual}: expected 0, or 2**-511 to 1")


def bits_of(number: float) -> int:
    """Of an IEEE 754 double."""
    bits: int = struct.unpack("<Q", struct.pack("<d", number))[0]
    return bits
