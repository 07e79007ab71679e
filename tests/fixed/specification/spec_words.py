"""The fixed-point solver, written from docs/fixed-point.md and from nothing else.

Integers of any length, one statement a rule; the sections' names stand where their rules do.
"""

from dataclasses import dataclass, field

Vector = list[int]


@dataclass(frozen=True)
class Settings:
    """The keys of the table [solver], by their names."""

    method: str
    start: str
    iterations: int
    stop_residual: float
    replace_residual_every: int
    matrix_bits: int
    vector_bits: int
    scalar_bits: int
    coefficient_bits: int
    coefficient_format: str
    alpha_fraction_bits: int
    beta_fraction_bits: int
    division_rounding: str
    shift_rounding: str
    overflow: str
    static_shift: int  # the one in force
    dynamic_scaling: bool
    scaling_down: bool
    scaling_threshold: int
    scaling_step: int
    headroom_bits: int

    @property
    def preconditioned(self) -> bool:
        return self.method in ("jacobi-pcg", "block-jacobi-pcg")

    @property
    def p(self) -> int:
        return max(0, self.matrix_bits + self.vector_bits + 4 - 32)

    @property
    def h(self) -> int:
        return self.p if self.preconditioned else self.static_shift

    @property
    def rhs_bits(self) -> int:
        return 32 if self.preconditioned else self.vector_bits

    @property
    def direction_target(self) -> int:
        return self.vector_bits - 1 - self.headroom_bits


@dataclass
class Scaled:
    """Words, worth word · 2^-exponent."""

    words: Vector
    exponent: int = 0

    def largest(self) -> int:
        return largest(self.words)


@dataclass(frozen=True)
class Scalar:
    word: int
    exponent: int


@dataclass(frozen=True)
class Coefficient:
    """Worth mantissa · 2^exponent."""

    mantissa: int = 0
    exponent: int = 0


@dataclass
class Counts:
    saturations: int = 0
    wraps: int = 0
    breakdowns: int = 0
    replacements: int = 0
    iterations: int = 0
    reached: bool = False
    flags: set[str] = field(default_factory=set)


def two_to(exponent: int) -> int:
    """Of an exponent that is not negative: an integer."""
    return 1 << exponent


def limit(bits: int) -> int:
    return two_to(bits - 1) - 1


def largest(words: Vector) -> int:
    return max((abs(word) for word in words), default=0)


def rounded_quotient(numerator: int, denominator: int, rounding: str) -> int:
    """numerator / denominator > 0, rounded on the magnitude."""
    whole, rest = divmod(abs(numerator), denominator)
    up = {
        "truncation": False,
        "nearest-up": 2 * rest >= denominator,
        "nearest-even": 2 * rest > denominator or (2 * rest == denominator and whole % 2 == 1),
    }[rounding]
    magnitude = whole + 1 if up else whole
    return -magnitude if numerator < 0 else magnitude


def times_power_of_two(value: int, exponent: int, rounding: str) -> int:
    if exponent >= 0:
        return value * two_to(exponent)
    return rounded_quotient(value, two_to(-exponent), rounding)


def nearest(numerator: int, denominator: int) -> int:
    return rounded_quotient(numerator, denominator, "nearest-up")


def clamped(value: int, bound: int) -> int:
    return max(-bound, min(bound, value))
