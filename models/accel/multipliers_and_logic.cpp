#include "models/accel/multipliers_and_logic.h"

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
  switch (w.method) {
    case Method::cg:
      return 0;
    case Method::jacobi_pcg:  // z = P⁻¹·r keeps pace with r; ‖r‖ is not zᵀr
      return wide + (w.stop_test ? wide : 0);
    case Method::block_jacobi_pcg:
      return 3 * wide + (w.stop_test ? wide : 0);
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
  const int scalars = recurrence ? 1 : 0;  // β²·dᵀA·d, step by step
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

namespace {

constexpr int kScalarBits = 64;
// States, counters of nodes, iterations and passes, exponents and shifts: registers of the
// sequencer, each with its next value's logic.
constexpr int kSequencerBits = 150;

// Ways that one look-up table chooses from: 4 data and 2 select of six inputs.
int ways_of(int inputs) {
  int ways = 2;
  while (2 * ways + bits_to_number(ways) <= inputs) ways *= 2;
  return ways;
}

class Estimate {
 public:
  Estimate(const Device& device, const Architecture& a, const WordLengths& w, const SystemSize& s)
      : mode_(multiplier_mode(device, a)), inputs_(device.logic.inputs), a_(a), w_(w), s_(s) {}

  std::vector<LogicUse> take() const {
    std::vector<LogicUse> all = {adder_trees(), operands(),
                                 own_words(),   vector_operands(),
                                 alignment(),   inner_products(),
                                 divider(),     {"sequencer", kSequencerBits, kSequencerBits}};
    if (a_.matrix_storage == MatrixStorage::symmetric) all.push_back(transposed_products());
    return all;
  }

 private:
  std::int64_t choose(int ways) const { return multiplexer_cells(ways, inputs_); }
  // A barrel shifter by any distance, in stages of as many ways as a look-up table has.
  std::int64_t shifter(std::int64_t bits) const {
    return bits * ceil_div(bits_to_number(bits), bits_to_number(ways_of(inputs_)));
  }

  // The product's adders and accumulators; what the multipliers' blocks sum is theirs.
  LogicUse adder_trees() const {
    const int product = w_.matrix_bits + w_.vector_bits;
    const int operands = static_cast<int>(ceil_div(a_.package, mode_.summed));
    const int bits = product + bits_to_number(mode_.summed) * (mode_.summed > 1 ? 1 : 0);
    const std::int64_t row = adder_tree_bits(operands, bits) + row_sum_bits(w_, s_.longest_row);
    const std::int64_t all = std::int64_t{a_.partitions} * a_.rows_in_parallel * row;
    return {"adder trees and accumulators", all, all};
  }

  // The other operand of each multiplier, sums over a node's rows and into the partial sums of
  // every column, and the partitions' sums added L nodes at a time.
  LogicUse transposed_products() const {
    const int sum = row_sum_bits(w_, s_.longest_row);
    const std::int64_t operands =
        std::int64_t{a_.rows_in_parallel} * a_.package * w_.vector_bits * choose(2);
    const std::int64_t column =
        adder_tree_bits(a_.rows_in_parallel, w_.matrix_bits + w_.vector_bits) + sum;
    const std::int64_t sums = a_.partitions * a_.package * column;
    const std::int64_t gathered = components() * adder_tree_bits(a_.partitions, sum);
    return {"transposed products", a_.partitions * operands + sums + gathered, sums + gathered};
  }

  // From the words of a package's nodes to its columns: the first is x, y or z. Half of the words
  // come with the first access of a double-pumped memory and wait for the others.
  LogicUse operands() const {
    const std::int64_t columns = std::int64_t{a_.package} * w_.vector_bits * choose(3);
    const int node = bits_to_number(s_.direction_nodes);
    const bool pumped = a_.direction_memory == DirectionMemory::double_pumped;
    const std::int64_t addresses = pumped ? 2 * node * choose(2) : 0;
    const std::int64_t words = 3 * std::int64_t{nodes_in_package(a_.package)} * w_.vector_bits;
    const int counters = bits_to_number(s_.packages) + 2 * bits_to_number(a_.result_queue);
    return {"operands of the multipliers", a_.partitions * (columns + addresses + counters),
            a_.partitions * (words / 2 + counters)};
  }

  // The words of d at the row's own node, caught as they pass for the inner product.
  LogicUse own_words() const {
    const int nodes = nodes_in_package(a_.package);
    const std::int64_t compared =
        nodes * ceil_div(2 * bits_to_number(s_.direction_nodes), inputs_ - 1);
    const std::int64_t words = 3 * std::int64_t{w_.vector_bits};
    return {"words of the row's own node", a_.partitions * (compared + words * choose(nodes)),
            a_.partitions * words};
  }

  // Components that the vector unit takes in a clock.
  std::int64_t components() const { return 3 * std::int64_t{a_.nodes_per_clock}; }

  // Fig. 5.10: a multiplexer and the absolute value before each multiplier.
  LogicUse vector_operands() const {
    const std::int64_t multipliers = vector_multipliers(mode_, a_, w_);
    return {"operands of the vector unit",
            multipliers * std::int64_t{w_.vector_bits} * (choose(2) + 1), 0};
  }

  // Products and the residual are shifted to their exponents, rounded, added and clamped. Groups b
  // and c share the shifters as they share the multipliers. Every rank carries the words of x and r
  // and a product.
  LogicUse alignment() const {
    const int residual = w_.preconditioned() ? kProductBits : w_.vector_bits;
    const int by_vector = w_.coefficient_bits + w_.vector_bits;
    const int by_product = w_.coefficient_bits + kProductBits;
    std::int64_t cells = by_product;  // the two halves of a product with A·d
    for (const int bits : {by_vector, by_product, residual}) cells += shifter(bits) + bits;
    cells += 2 * (2 * w_.vector_bits + residual);  // sums and clamps of x, d and r
    const std::int64_t ranks = a_.multiplier_clocks + a_.vector_clocks();
    const std::int64_t words = std::int64_t{w_.vector_bits} + residual + kProductBits;
    return {"shifters, rounding and clamps", components() * cells, components() * ranks * words};
  }

  LogicUse inner_products() const {
    const std::int64_t bits =
        adder_tree_bits(static_cast<int>(components()), w_.vector_bits + kProductBits) +
        kScalarBits;
    return {"inner products", bits, bits};
  }

  // A subtractor and a choice a bit; remainder, divisor, quotient and dividend.
  LogicUse divider() const {
    return {"divider", kScalarBits * (1 + choose(2)), std::int64_t{4} * kScalarBits};
  }

  const MultiplierMode& mode_;
  int inputs_;
  const Architecture& a_;
  const WordLengths& w_;
  const SystemSize& s_;
};

}  // namespace

std::int64_t multiplexer_cells(int ways, int inputs) {
  return ceil_div(ways - 1, ways_of(inputs) - 1);
}

std::int64_t adder_tree_bits(int operands, int bits) {
  std::int64_t sum = 0;
  while (operands > 1) {
    ++bits;
    sum += std::int64_t{operands / 2} * bits;
    operands = operands / 2 + operands % 2;
  }
  return sum;
}

std::vector<LogicUse> logic(const Device& device, const Architecture& a, const WordLengths& w,
                            const SystemSize& s) {
  return Estimate(device, a, w, s).take();
}

}  // namespace hvp::accel
