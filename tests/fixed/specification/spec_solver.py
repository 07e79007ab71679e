"""A solve in words: docs/fixed-point.md, from "Words" to "Flags"."""

import math
from dataclasses import dataclass

from spec_matrix import Matrix, Preconditioner
from spec_registers import Registers
from spec_words import (
    Coefficient,
    Scalar,
    Scaled,
    Settings,
    Vector,
    largest,
    two_to,
)


@dataclass(frozen=True)
class Iteration:
    """What an iteration leaves; vectors that the method does not have are empty."""

    vectors: dict[str, Vector]
    d_q: int
    z_r: int
    alpha: Coefficient  # as it applies to q, for words of r as they were
    beta: Coefficient
    residual_exponent: int  # of r · 2^h
    direction_exponent: int  # of d in units of z


class Solver(Registers):
    """One solve. The matrix is as the last contact left it."""

    def __init__(self, settings: Settings, matrix: Matrix) -> None:
        super().__init__(settings)
        self.a = matrix
        self.inverse = Preconditioner(settings, matrix, self.counts.flags)
        self.x: Vector = []
        self.b: Vector = []
        self.r = self.z = self.d = self.q = self.w = self.n = self.v = Scaled([])
        self.gamma = self.eta = Scalar(0, 0)
        self.alpha = self.beta = Coefficient()
        self.progress = Progress()
        self.start_norm = 0.0
        self.stopped = False

    # The loop

    def product(self, vector: Scaled) -> Scaled:
        sums = self.a.times(vector.words)
        words = [self.write(self.shifted(total, -self.s.p), 32) for total in sums]
        return Scaled(words, vector.exponent - self.s.p)

    def precondition(self) -> None:
        if not self.s.preconditioned:
            self.z = Scaled(list(self.r.words), self.r.exponent)
            return
        words = [
            self.write(self.shifted(t, -self.inverse.w), 32)
            for t in self.inverse.sums(self.r.words)
        ]
        self.z = Scaled(words, self.r.exponent + self.inverse.k - self.inverse.w)

    def filled(self, vector: Scaled, without_scaling: int) -> Scaled:
        exponent = without_scaling
        if self.s.dynamic_scaling:
            exponent = vector.exponent + self.s.direction_target - vector.largest().bit_length()
        shift = exponent - vector.exponent
        words = [self.write(self.shifted(word, shift), self.s.vector_bits) for word in vector.words]
        return Scaled(words, exponent)

    def form_residual(self) -> None:
        s = self.s
        q = self.product(Scaled(self.x)).words
        v = [b * two_to(s.h) - word * two_to(s.p) for b, word in zip(self.b, q, strict=True)]
        exponent = -s.h
        if s.dynamic_scaling and any(v):
            exponent = self.residual_target - largest(v).bit_length()
        self.r = Scaled([self.write(self.shifted(i, exponent), s.rhs_bits) for i in v], exponent)
        self.residual_formed = v

    @property
    def residual_target(self) -> int:
        return 25 if self.s.preconditioned else self.s.direction_target

    @property
    def residual_available(self) -> int:
        return 25 if self.s.preconditioned else self.s.vector_bits - 1

    def start(self, b: Vector, guess: Vector) -> None:
        s = self.s
        self.x = [self.write(0 if s.start == "zero" else x, s.vector_bits) for x in guess]
        self.b = [self.write(word, s.rhs_bits) for word in b]
        self.form_residual()
        self.start_norm = norm(self.residual_formed)
        self.precondition()
        self.gamma = self.inner_product(self.z, self.r)
        self.d = self.filled(self.z, 0 if s.preconditioned else self.z.exponent)
        if self.by_recurrence:
            self.form_recurrences()
            self.eta = self.inner_product(self.w, self.r)

    def advance(self, r: Scaled, q: Scaled, bits: int, target: int, room: int) -> Scaled:
        """r less alpha times q."""
        exponent = self.alpha.exponent - q.exponent + r.exponent
        size = abs(self.alpha.mantissa) * q.largest()
        s = self.rescaling([(r.largest(), 0), (size, exponent)], bits, target, room)
        words = [
            self.write(self.shifted(word, s) - self.scaled(self.alpha, other, exponent + s), bits)
            for word, other in zip(r.words, q.words, strict=True)
        ]
        return Scaled(words, r.exponent + s)

    def follow(self, d: Scaled, z: Scaled) -> Scaled:
        """z plus β·d."""
        bits = self.s.vector_bits
        s = 0
        if self.gamma.word > 0:
            carried = abs(self.beta.mantissa) * d.largest()
            terms = [(z.largest(), d.exponent - z.exponent), (carried, self.beta.exponent)]
            s = self.rescaling(terms, bits, self.s.direction_target, bits - 1)
        exponent = d.exponent + s
        words = [
            self.write(
                self.shifted(new, exponent - z.exponent)
                + self.scaled(self.beta, old, self.beta.exponent + s),
                bits,
            )
            for new, old in zip(z.words, d.words, strict=True)
        ]
        return Scaled(words, exponent)

    def form_alpha(self) -> None:
        self.alpha = self.quotient(self.gamma, self.eta, self.s.alpha_fraction_bits)

    def form_beta(self, before: Scalar) -> None:
        self.beta = Coefficient()
        if self.gamma.word > 0:
            self.beta = self.quotient(self.gamma, before, self.s.beta_fraction_bits)

    def advance_solution(self) -> None:
        self.x = [
            self.write(
                x + self.scaled(self.alpha, d, self.alpha.exponent - self.d.exponent),
                self.s.vector_bits,
            )
            for x, d in zip(self.x, self.d.words, strict=True)
        ]
        self.counts.iterations += 1

    def replaces(self) -> bool:
        every = self.s.replace_residual_every
        if every == 0 or self.counts.iterations % every != 0:
            return False
        self.counts.replacements += 1
        return True

    def advance_residual(self) -> None:
        self.r = self.advance(
            self.r, self.q, self.s.rhs_bits, self.residual_target, self.residual_available
        )

    def reached(self) -> bool:
        t = self.s.stop_residual
        if t == 0:
            return False
        r = math.ldexp(float(sum(w * w for w in self.r.words)), -2 * self.r.exponent)
        b = math.ldexp(float(sum(w * w for w in self.b)), 2 * self.s.h)
        return r <= (t * t) * b

    def nothing_left(self) -> bool:
        self.stopped = self.gamma.word <= 0 or not any(self.d.words)
        return self.stopped

    def negative_curvature(self) -> bool:
        if self.eta.word > 0:
            return False
        self.counts.flags.add("negative-curvature")
        self.counts.breakdowns += 1
        return True

    def iteration(self) -> Coefficient | None:
        """None where it ends; else alpha as it applies to q."""
        if self.nothing_left():
            return None
        self.q = self.product(self.d)
        self.eta = self.inner_product(self.d, self.q)
        if self.negative_curvature():
            return None
        self.form_alpha()
        shown = self.alpha_for_q()
        self.advance_solution()
        if self.replaces():
            self.form_residual()
        else:
            self.advance_residual()
        self.precondition()
        before = self.gamma
        self.gamma = self.inner_product(self.z, self.r)
        self.form_beta(before)
        self.d = self.follow(self.d, self.z)
        return shown

    def alpha_for_q(self) -> Coefficient:
        exponent = self.alpha.exponent - self.q.exponent + self.r.exponent
        return Coefficient(self.alpha.mantissa, exponent)

    # Fewer synchronisations

    @property
    def by_recurrence(self) -> bool:
        return self.s.method in ("chronopoulos-gear", "pipelined-cg")

    @property
    def pipelined(self) -> bool:
        return self.s.method == "pipelined-cg"

    def form_recurrences(self) -> None:
        if not self.pipelined:
            self.w = self.product(self.r)
            self.q = self.product(self.d)
            return
        m = self.s.static_shift
        self.w = self.filled(self.product(self.r), self.r.exponent - m)
        self.q = self.filled(self.product(self.d), self.d.exponent - m)
        self.n = self.product(self.w)
        self.v = self.product(self.q)

    def follow_curvature(self) -> None:
        delta = self.inner_product(self.w, self.r)
        n1 = self.s.coefficient_bits - 1
        beta = self.beta
        once = self.shifted_scalar(beta.mantissa * self.eta.word, -n1)
        exponent = 2 * beta.exponent + n1 - self.eta.exponent + delta.exponent
        twice = self.shifted_scalar(beta.mantissa * once, exponent)
        self.eta = Scalar(self.write_scalar(delta.word - twice), delta.exponent)
        if self.eta.word <= 0 and delta.word > 0:
            self.beta = Coefficient()
            self.eta = delta

    def follow_product(self, q: Scaled, w: Scaled, vector_exponent: int) -> Scaled:
        exponent = vector_exponent - self.s.p
        grown = exponent - q.exponent
        words = [
            self.write(
                self.shifted(new, exponent - w.exponent)
                + self.scaled(self.beta, old, self.beta.exponent + grown),
                32,
            )
            for new, old in zip(w.words, q.words, strict=True)
        ]
        return Scaled(words, exponent)

    def iteration_by_recurrence(self) -> Coefficient | None:
        if self.nothing_left() or self.negative_curvature():
            return None
        self.form_alpha()
        shown = self.alpha_for_q()
        self.advance_solution()
        replaced = self.replaces()
        if replaced:
            self.form_residual()
            self.form_recurrences()
        else:
            self.advance_residual()
            self.advance_products()
        self.precondition()
        before = self.gamma
        self.gamma = self.inner_product(self.z, self.r)
        self.form_beta(before)
        if replaced:
            self.beta = Coefficient()
        self.follow_curvature()
        self.d = self.follow(self.d, self.z)
        if self.pipelined:
            self.q = self.follow(self.q, self.w)
            self.v = self.follow_product(self.v, self.n, self.q.exponent)
        else:
            self.q = self.follow_product(self.q, self.w, self.d.exponent)
        return shown

    def advance_products(self) -> None:
        bits = self.s.vector_bits
        if self.pipelined:
            self.w = self.advance(self.w, self.v, bits, self.s.direction_target, bits - 1)
            self.n = self.product(self.w)
        else:
            self.w = self.product(self.r)

    # Flags

    def judge(self) -> dict[str, float]:
        counts, h = self.counts, self.s.h
        b = [word * two_to(h) for word in self.b]
        ax = self.a.times(self.x)
        norms = {
            "rhs_norm": norm(b),
            "start_residual_norm": self.start_norm,
            "residual_norm": math.ldexp(norm(self.r.words), -self.r.exponent),
            "true_residual_norm": norm([i - j for i, j in zip(b, ax, strict=True)]),
            "rounding_floor": norm(self.a.row_magnitudes()),
        }
        if counts.saturations > 0:
            counts.flags.add("saturation")
        if counts.wraps > 0:
            counts.flags.add("wrapped")
        if self.stopped and any(self.r.words):
            counts.flags.add("stagnation")
        floors = 4 * norms["rounding_floor"]
        true = norms["true_residual_norm"]
        if true > floors:
            if self.progress.last < counts.iterations // 2:
                counts.flags.add("stagnation")
            if true > 2 * norms["residual_norm"] + floors:
                counts.flags.add("stagnation")
            if true > max(norms["rhs_norm"], norms["start_residual_norm"]):
                counts.flags.add("divergence")
        return norms

    def solve(self, b: Vector, guess: Vector) -> tuple[list[Iteration], dict[str, float]]:
        history: list[Iteration] = []
        self.start(b, guess)
        self.progress.note(self.gamma, 0)
        while self.counts.iterations < self.s.iterations:
            if self.reached():
                self.counts.reached = True
                break
            alpha = self.iteration_by_recurrence() if self.by_recurrence else self.iteration()
            if alpha is None:
                break
            self.progress.note(self.gamma, self.counts.iterations)
            history.append(self.seen(alpha))
        return history, self.judge()

    def seen(self, alpha: Coefficient) -> Iteration:
        vectors = {"x": self.x, "r": self.r.words, "z": self.z.words, "d": self.d.words}
        vectors |= {"q": self.q.words, "w": self.w.words, "n": self.n.words, "v": self.v.words}
        return Iteration(
            vectors,
            self.eta.word,
            self.gamma.word,
            alpha,
            self.beta,
            self.r.exponent + self.s.h,
            self.d.exponent - self.z.exponent,
        )


@dataclass
class Progress:
    """The least zᵀr so far, and after which iteration it came."""

    least: float = math.inf
    last: int = 0

    def note(self, gamma: Scalar, iteration: int) -> None:
        worth = math.ldexp(float(gamma.word), -gamma.exponent)
        if worth < self.least:
            self.least, self.last = worth, iteration


def norm(words: Vector) -> float:
    total = 0.0
    for word in words:
        total += float(word) * float(word)
    return math.sqrt(total)
