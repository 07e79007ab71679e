// The choice of passes, and the exact passes for vectors for which no fast one is proved safe.
#include <algorithm>
#include <cstdint>

#include "models/fixed/fast/fast_solver.h"
#include "models/index.h"

namespace hvp::fixed::fast {

namespace {

constexpr std::uint64_t kLargestSum = (std::uint64_t{1} << 31) - 1;

RightShift right_shift(int places, Rounding rounding) {
  RightShift result{.right = static_cast<std::uint32_t>(places)};
  if (places == 0) return result;
  const std::uint64_t half = std::uint64_t{1} << (places - 1);
  switch (rounding) {
    case Rounding::truncation:
      result.below_zero = static_cast<std::int64_t>(2 * half - 1);
      break;
    case Rounding::nearest_up:
      result.bias = half;
      result.below_zero = -1;
      break;
    case Rounding::nearest_even:
      result.bias = half - 1;
      result.odd = 1;
      break;
  }
  return result;
}

// More than any rounding of size · 2^-places.
std::uint64_t shifted_bound(std::uint64_t size, int places) { return (size >> places) + 1; }

}  // namespace

void FastSolver::count(std::int64_t overflows) {
  if (settings_.overflow == Overflow::saturate) {
    report_.saturations += overflows;
  } else {
    report_.wraps += overflows;
  }
}

// Entries of two vectors in one accumulator of a lane.
bool FastSolver::dot_fits(std::uint64_t a, std::uint64_t b) const {
  return width(a) + width(b) + lane_products_bits_ <= 63;
}

Terms FastSolver::terms_of(Vector& out, const Term& a, const Term& b, int bits, Wants wants) const {
  return {.out = out.word.data(),
          .a = a.vector.word.data(),
          .b = b.vector.word.data(),
          .size = out.word.size(),
          .bits = bits,
          .wraps = settings_.overflow == Overflow::wrap,
          .nearest_even = settings_.shift_rounding == Rounding::nearest_even,
          .square = wants == Wants::squares};
}

// first = word(first + first_b) and second = word(second_a + second_b), in one pass over the
// vector that the two b share where that is simple. It may be `second`.
void FastSolver::write_both(Vector& first, const Term& first_b, Vector& second,
                            const Term& second_a, const Term& second_b, int bits) {
  const Term first_a{.vector = first};
  Terms one = terms_of(first, first_a, first_b, bits, Wants::nothing);
  Terms other = terms_of(second, second_a, second_b, bits, Wants::nothing);
  if (prove(one, first_a, first_b) && one.short_product && one.fits &&
      prove(other, second_a, second_b) && other.short_product && other.fits) {
    const FoundBoth found = passes_.combine_both(one, other);
    first.largest = found.first.largest;
    second.largest = found.second.largest;
    return;
  }
  write(first, first_a, first_b, bits);
  write(second, second_a, second_b, bits);
}

// out = word(a + b), term by term rounded.
void FastSolver::write(Vector& out, const Term& a, const Term& b, int bits, Wants wants) {
  Terms terms = terms_of(out, a, b, bits, wants);
  const Found found = prove(terms, a, b) ? passes_.combine(terms) : write_exactly(out, a, b, bits);
  out.largest = found.largest;
  count(found.overflows);
  if (wants == Wants::squares) z_r_sum_ = found.dot;
}

// Fills in the shifts, and says whether the pass keeps its promises for these magnitudes.
bool FastSolver::prove(Terms& terms, const Term& a, const Term& b) const {
  const Rounding rounding = settings_.shift_rounding;
  std::uint64_t a_bound = 0;
  if (a.vector.largest > kLargestSum) return false;
  if (a.vector.largest == 0) {
    // Nothing to shift.
  } else if (a.exponent >= 0) {
    if (width(a.vector.largest) + a.exponent > 31) return false;
    terms.a_left = static_cast<std::uint32_t>(a.exponent);
    a_bound = a.vector.largest << a.exponent;
  } else if (a.vector.largest >= 1U << 30) {
    return false;
  } else if (a.exponent >= -31) {
    terms.a_right = right_shift(-a.exponent, rounding);
    a_bound = shifted_bound(a.vector.largest, -a.exponent);
  } else {
    terms.a_right = right_shift(31, Rounding::truncation);  // nothing is left
  }

  const std::uint64_t product = size_of(b.factor) * b.vector.largest;
  std::uint64_t b_bound = 0;
  if (product == 0 || b.exponent < -60) {
    // Magnitudes below 2^56: nothing is left.
  } else if (b.exponent > 0) {
    if (width(product) + b.exponent > 31) return false;
    terms.factor = b.factor * (std::int32_t{1} << b.exponent);
    b_bound = product << b.exponent;
  } else {
    terms.factor = b.factor;
    terms.b_right = right_shift(-b.exponent, rounding);
    b_bound = shifted_bound(product, -b.exponent);
  }
  terms.short_product =
      terms.factor == 0 || (size_of(terms.factor) < (1U << 15) && b.vector.largest < (1U << 15) &&
                            product < (1U << 30) && b_bound < (1U << 30));
  if (terms.short_product && terms.b_right.right > 31) {
    terms.factor = 0;
    terms.b_right = {};
  }
  terms.split_product = !terms.nearest_even && size_of(terms.factor) < (1U << 15) &&
                        b.vector.largest <= kLargestSum && terms.b_right.right >= 17 &&
                        terms.b_right.right <= 47;
  const std::uint64_t sum = a_bound + b_bound;
  terms.fits = sum <= static_cast<std::uint64_t>(largest_word(terms.bits));
  const std::uint64_t word = std::min(sum, std::uint64_t{1} << (terms.bits - 1));
  return sum <= kLargestSum && (!terms.square || dot_fits(word, word));
}

Found FastSolver::write_exactly(Vector& out, const Term& a, const Term& b, int bits) const {
  const Shift a_shift(a.exponent, settings_.shift_rounding);
  const Shift b_shift(b.exponent, settings_.shift_rounding);
  Found found;
  for (std::size_t i = 0; i < out.word.size(); ++i) {
    const std::int64_t sum =
        a_shift(a.vector.word[i]) + b_shift(std::int64_t{b.factor} * b.vector.word[i]);
    const std::int32_t word = to_word(sum, bits, settings_.overflow, found.overflows);
    out.word[i] = word;
    found.largest = std::max(found.largest, size_of(word));
    found.dot += std::int64_t{word} * word;
  }
  return found;
}

// product becomes b · 2^rhs_shift - product, where 32 bits hold every word of it; else nothing
// happens. Returns the sum of their squares.
std::optional<Int128> FastSolver::subtract_from_rhs(Vector& product) {
  const Term b{.vector = b_, .exponent = settings_.rhs_shift()};
  const Term subtracted{.vector = product, .factor = -1};
  Terms terms = terms_of(product, b, subtracted, Settings::kProductBits, Wants::squares);
  if (!prove(terms, b, subtracted)) return std::nullopt;
  const Found found = passes_.combine(terms);
  product.largest = found.largest;
  return found.dot;
}

// The sum of a vector's squares in doubles, given the exact one. Below 2^53 no partial sum is
// rounded, whatever the order; beyond, the sum runs over the rows in the matrix' order: the
// reference's norms are the same to the bit.
double FastSolver::square_sum(const Vector& vector, Int128 exact) const {
  if (exact < Int128{1} << 53) return static_cast<double>(exact);
  double sum = 0;
  for (int node = 0; node < packed_.nodes(); ++node) {
    const std::size_t first = packed_.first_row(node);
    for (std::size_t i = first; i < first + 3; ++i) {
      const auto word = static_cast<double>(vector.word[i]);
      sum += word * word;
    }
  }
  return sum;
}

// aᵀb; finds the largest of b besides.
Int128 FastSolver::dot(const Vector& a, Vector& b) {
  if (dot_fits(a.largest, b.largest)) {
    const Found found = passes_.inner_product(a.word.data(), b.word.data(), a.word.size());
    b.largest = found.largest;
    return found.dot;
  }
  Int128 sum = 0;
  b.largest = 0;
  for (std::size_t i = 0; i < a.word.size(); ++i) {
    sum += std::int64_t{a.word[i]} * b.word[i];
    b.largest = std::max(b.largest, size_of(b.word[i]));
  }
  return sum;
}

// The exact sums of A·vector: in sums_, but in `paired` where the matrix is paired. Returns their
// inner product with the vector then, if dot_fits() says that it fits.
Int128 FastSolver::sum_rows(const Vector& vector, Vector& paired) {
  if (!packed_.paired()) {
    passes_.multiply_wide(packed_.wide_slices(), vector.word.data(), sums_.data());
    return 0;
  }
  passes_.to_short(vector.word.data(), short_.data(), vector.word.size());
  const Found found =
      passes_.multiply_paired(packed_.paired_slices(), short_.data(), paired.word.data());
  paired.largest = found.largest;
  return found.dot;
}

// product = A·vector, rounded and cut to its word. Returns their inner product.
Int128 FastSolver::multiply(const Vector& vector, int exponent, Vector& product) {
  const int dropped = settings_.product_shift();
  product.exponent = exponent - dropped;
  if (packed_.paired() && dropped == 0) {
    const Int128 sum = sum_rows(vector, product);
    return dot_fits(vector.largest, product.largest) ? sum : dot(vector, product);
  }
  sum_rows(vector, product_);
  if (packed_.paired()) {
    write(product, {.vector = product_, .exponent = -dropped}, {.vector = product_, .factor = 0},
          Settings::kProductBits);
  } else {
    write_sums(product, -dropped, Settings::kProductBits);
  }
  return dot(vector, product);
}

// The words of sums_ · 2^exponent. Where they fit 32 bits, so that a pass can write them.
void FastSolver::write_sums(Vector& out, int exponent, int bits, Wants wants) {
  std::uint64_t all = 0;  // as many bits as the widest has
  for (std::size_t i = 0; i < out.word.size(); ++i) {
    all |= size_of(sums_[i]);
    out.word[i] = static_cast<std::int32_t>(sums_[i]);
  }
  if (all <= kLargestSum) {
    out.largest = all;
    write(out, {.vector = out, .exponent = exponent}, {.vector = out, .factor = 0}, bits, wants);
    return;
  }
  const Shift shift(exponent, settings_.shift_rounding);
  std::int64_t overflows = 0;
  Int128 squares = 0;
  out.largest = 0;
  for (std::size_t i = 0; i < out.word.size(); ++i) {
    const std::int32_t word = to_word(shift(sums_[i]), bits, settings_.overflow, overflows);
    out.word[i] = word;
    out.largest = std::max(out.largest, size_of(word));
    squares += std::int64_t{word} * word;
  }
  count(overflows);
  if (wants == Wants::squares) z_r_sum_ = squares;
}

// z = P⁻¹·r, and zᵀr.
void FastSolver::precondition() {
  if (!preconditioned()) return;
  z_.exponent = r_.exponent + preconditioner_.scale_bits() - preconditioner_.dropped();
  // |P⁻¹·r| / 2^dropped <= |r|.
  if (preconditioner_.blocks() || r_.largest > kLargestSum || !dot_fits(r_.largest, r_.largest)) {
    if (preconditioner_.blocks()) {
      passes_.multiply_wide(preconditioner_.slices(), r_.word.data(), sums_.data());
    } else {
      for (std::size_t i = 0; i < r_.word.size(); ++i) {
        sums_[i] = std::int64_t{preconditioner_.diagonal()[i]} * r_.word[i];
      }
    }
    write_sums(z_, -preconditioner_.dropped(), Settings::kProductBits);
    z_r_sum_ = dot(r_, z_);
    return;
  }
  const Found found = passes_.multiply_entries(
      {.out = z_.word.data(),
       .in = r_.word.data(),
       .factor = preconditioner_.diagonal(),
       .size = r_.word.size(),
       .shift = right_shift(preconditioner_.dropped(), settings_.shift_rounding)});
  z_.largest = found.largest;
  z_r_sum_ = found.dot;
}

void FastSolver::take(const Job& job) {
  if (settings_.start == Start::zero) {
    std::ranges::fill(x_.word, 0);
    x_.largest = 0;
  } else {
    take(job.x, settings_.vector_bits, x_);
  }
  take(job.b, settings_.residual_bits(), b_);
  rhs_squares_ = dot(b_, b_);
  stop_test_ =
      StopTest(settings_.stop_residual, static_cast<UInt128>(rhs_squares_), settings_.rhs_shift());
}

// A vector in the matrix' order, cut to so many bits.
void FastSolver::take(std::span<const std::int32_t> words, int bits, Vector& to) {
  for (int node = 0; node < packed_.nodes(); ++node) {
    const std::size_t first = packed_.first_row(node);
    for (std::size_t c = 0; c < 3; ++c) to.word[first + c] = words[3 * at(node) + c];
  }
  const Found found = passes_.combine({.out = to.word.data(),
                                       .a = to.word.data(),
                                       .b = to.word.data(),
                                       .size = to.word.size(),
                                       .bits = bits,
                                       .wraps = settings_.overflow == Overflow::wrap,
                                       .short_product = true});
  to.largest = found.largest;
  count(found.overflows);
}

// The solution, in the matrix' order.
void FastSolver::hand_over(std::span<std::int32_t> solution) const {
  for (int node = 0; node < packed_.nodes(); ++node) {
    const std::size_t first = packed_.first_row(node);
    for (std::size_t c = 0; c < 3; ++c) solution[3 * at(node) + c] = x_.word[first + c];
  }
}

}  // namespace hvp::fixed::fast
