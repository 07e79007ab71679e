"""How a value becomes a word, in a solve: docs/fixed-point.md, "Words" and "Dynamic scaling"."""

from spec_words import (
    Coefficient,
    Counts,
    Scalar,
    Scaled,
    Settings,
    clamped,
    limit,
    rounded_quotient,
    times_power_of_two,
    two_to,
)


class Registers:
    """Counts and flags what does not fit."""

    def __init__(self, settings: Settings) -> None:
        self.s = settings
        self.counts = Counts()

    def wrapped(self, value: int, bits: int) -> int:
        low = value % two_to(bits)
        return low - two_to(bits) if low >= two_to(bits - 1) else low

    def write(self, value: int, bits: int) -> int:
        if abs(value) <= limit(bits):
            return value
        if self.s.overflow == "saturate":
            self.counts.saturations += 1
            return clamped(value, limit(bits))
        self.counts.wraps += 1
        return self.wrapped(value, bits)

    def shifted(self, value: int, exponent: int) -> int:
        return clamped(times_power_of_two(value, exponent, self.s.shift_rounding), 2**61)

    def scaled(self, coefficient: Coefficient, word: int, exponent: int) -> int:
        return self.shifted(coefficient.mantissa * word, exponent)

    def write_scalar(self, value: int) -> int:
        bits = self.s.scalar_bits
        if abs(value) <= limit(bits):
            return value
        self.counts.flags.add("scalar-overflow")
        if self.s.overflow == "saturate":
            return clamped(value, limit(bits))
        self.counts.wraps += 1
        return self.wrapped(value, bits)

    def inner_product(self, a: Scaled, b: Scaled) -> Scalar:
        exact = sum(one * other for one, other in zip(a.words, b.words, strict=True))
        return Scalar(self.write_scalar(exact), a.exponent + b.exponent)

    def quotient(self, n: Scalar, d: Scalar, fraction_bits: int) -> Coefficient:
        """Coefficients; the exponents of the inner products are counted."""
        bits = self.s.coefficient_bits
        rounding = self.s.division_rounding
        own = d.exponent - n.exponent
        if self.s.coefficient_format == "fixed":
            exact = rounded_quotient(n.word * two_to(fraction_bits), d.word, rounding)
            return Coefficient(self.write(exact, bits), own - fraction_bits)
        if n.word == 0:
            return Coefficient()
        e = n.word.bit_length() - d.word.bit_length() - (bits - 2)
        if n.word * two_to(max(0, -e)) < d.word * two_to(bits - 2 + max(0, e)):
            e -= 1
        numerator, denominator = n.word * two_to(max(0, -e)), d.word * two_to(max(0, e))
        mantissa = rounded_quotient(numerator, denominator, rounding)
        if mantissa == two_to(bits - 1):
            return Coefficient(mantissa // 2, own + e + 1)
        return Coefficient(mantissa, own + e)

    def rescaling(self, terms: list[tuple[int, int]], bits: int, target: int, room: int) -> int:
        """Dynamic scaling: s."""
        s = self.s
        if not s.dynamic_scaling:
            return 0
        terms = [(size, exponent) for size, exponent in terms if size != 0]
        f = 0
        if terms:
            unit = max(size.bit_length() + exponent for size, exponent in terms) - 40
            total = sum(
                size << (exponent - unit) if exponent >= unit else (size >> (unit - exponent)) + 1
                for size, exponent in terms
            )
            f = (total + (total >> (bits - 3))).bit_length() + unit
        if target - f >= s.scaling_threshold:
            return (target - f) // s.scaling_step * s.scaling_step
        if f > room and s.scaling_down:
            return -(-(-(f - room) // s.scaling_step) * s.scaling_step)
        return 0

    def shifted_scalar(self, value: int, exponent: int) -> int:
        result = times_power_of_two(value, exponent, self.s.shift_rounding)
        if abs(result) > 2**100:
            self.counts.flags.add("scalar-overflow")
        return clamped(result, 2**100)
