#include "models/accel/multipliers.h"

#include <algorithm>
#include <string>

#include "models/accel/bits.h"
#include "models/config/input_error.h"

namespace hvp::accel {

namespace {

using fixed::Method;

// §6.1: multipliers of the vector unit beside those of SpMxV, for 16-bit vectors and two nodes a
// clock.
constexpr int kVectorMultipliers = 21;
// The mantissa of the stop test's limit.
constexpr int kLimitBits = 53;

int pieces(int bits, int operand) { return static_cast<int>(ceil_div(bits - 1, operand - 1)); }

// The multipliers of one component of a node beyond plain CG. Group c uses the multipliers of group
// b, unless they are one pass: without dynamic scaling, where no size of a vector has to be
// awaited.
int further_products(const MultiplierMode& mode, const WordLengths& w) {
  const auto products = [&mode](int bits, int other) {
    return multipliers_a_product(mode, bits, other);
  };
  const int by_vector = products(w.coefficient_bits, w.vector_bits);
  const int by_product = products(w.coefficient_bits, kProductBits);
  const int words = products(w.vector_bits, w.vector_bits);
  const int wide = products(kProductBits, kProductBits);
  // With a preconditioner r and z are as long as a product, and zᵀr stands where rᵀr has one of
  // plain CG's products.
  const int inner = wide - by_vector;
  switch (w.method) {
    case Method::cg:
      return 0;
    case Method::jacobi_pcg:  // z = P⁻¹·r keeps pace with r; ‖r‖ is not zᵀr
      return wide + inner + (w.stop_test ? wide : 0);
    case Method::block_jacobi_pcg:
      return 3 * wide + inner + (w.stop_test ? wide : 0);
    case Method::chronopoulos_gear:  // with c in b's pass: β·d and β·q
      return w.dynamic_scaling ? 0 : by_vector + by_product;
    case Method::pipelined_cg:  // α·v and wᵀr, and q is a vector word; β·d, β·q and β·v
      return by_vector + words + (w.dynamic_scaling ? 0 : 2 * by_vector + by_product);
  }
  return 0;
}

// Multipliers of a summing mode that a product of its own keeps from others.
std::int64_t alone(const Device& device, const MultiplierMode& mode, std::int64_t products) {
  if (mode.summed == 1) return products;
  for (const MultiplierMode& other : device.multipliers) {
    if (other.summed == 1 && other.count > 0) return ceil_div(products * mode.count, other.count);
  }
  return products * mode.summed;
}

}  // namespace

const MultiplierMode& multiplier_mode(const Device& device, const Architecture& a) {
  if (a.multiplier_mode == "auto") return device.multipliers.front();
  const auto found =
      std::ranges::find(device.multipliers, a.multiplier_mode, &MultiplierMode::name);
  if (found != device.multipliers.end()) return *found;
  std::string names = "auto";
  for (const MultiplierMode& mode : device.multipliers) names += ", " + mode.name;
  throw InputError("multiplier_mode", "the " + device.name + " has " + names + ": found \"" +
                                          a.multiplier_mode + "\"");
}

int multipliers_a_product(const MultiplierMode& mode, int bits, int other_bits) {
  return std::min(pieces(bits, mode.bits) * pieces(other_bits, mode.other_bits),
                  pieces(other_bits, mode.bits) * pieces(bits, mode.other_bits));
}

std::int64_t vector_multipliers(const MultiplierMode& mode, const Architecture& a,
                                const WordLengths& w) {
  const bool recurrence = w.method == Method::chronopoulos_gear || w.method == Method::pipelined_cg;
  const std::int64_t plain =
      ceil_div(std::int64_t{kVectorMultipliers} * a.nodes_per_clock *
                   multipliers_a_product(mode, w.coefficient_bits, w.vector_bits),
               2);
  // β²·dᵀA·d, step by step; the stop test's limit, eight bits of a product a clock.
  const int scalars = (recurrence ? 1 : 0) + (w.stop_test ? ceil_div(kLimitBits, mode.bits) : 0);
  return plain + std::int64_t{3} * further_products(mode, w) * a.nodes_per_clock + scalars;
}

std::int64_t multipliers(const Device& device, const Architecture& a, const WordLengths& w) {
  const MultiplierMode& mode = multiplier_mode(device, a);
  // Pieces of a product have different weights and cannot be summed with each other.
  const std::int64_t a_row = ceil_div(a.package, mode.summed) * mode.summed *
                             multipliers_a_product(mode, w.matrix_bits, w.vector_bits);
  return std::int64_t{a.rows_in_parallel} * a.partitions * a_row +
         alone(device, mode, vector_multipliers(mode, a, w));
}

}  // namespace hvp::accel
