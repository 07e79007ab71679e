#include "models/accel/engine_logic.h"

#include <algorithm>
#include <cmath>

#include "models/accel/bits.h"
#include "models/accel/symmetric.h"

namespace hvp::accel {

namespace {

// Look-up tables that yosys needs for each that is counted below, over the engines that calibrate
// them; docs/synthesis.md has the same figures from its measurements.
constexpr double kPartition = 1.13;
constexpr double kBanks = 0.74;
constexpr double kLane = 0.84;
constexpr double kCollector = 1.03;
constexpr double kSums = 1.23;
constexpr double kSequencer = 1.62;
constexpr double kDivider = 1.35;
constexpr double kScaler = 1.32;
constexpr double kStopTest = 1.25;
constexpr double kEditor = 0.87;
constexpr double kInverse = 1.29;
constexpr double kSettings = 1.04;
constexpr double kBetween = 0.34;

constexpr int kExponentBits = 22;
constexpr int kTermBits = 40;      // of a re-scaling
constexpr int kMantissaBits = 53;  // of the stop test's limit

// Ways that one look-up table chooses from: 4 data and 2 select of six inputs.
int ways_of(int inputs) {
  int ways = 2;
  while (2 * ways + bits_to_number(ways) <= inputs) ways *= 2;
  return ways;
}

class EngineLogic {
 public:
  EngineLogic(const Device& device, const Architecture& a, const WordLengths& w,
              const SystemSize& s)
      : inputs_(device.logic.inputs), a_(a), w_(w), e_(engine_words(a, w, s)) {}

  std::vector<LogicUse> take() const {
    const int partitions = a_.partitions;
    std::vector<LogicUse> all = {
        {"partition", partitions, partition(), kPartition},
        {"lane", std::int64_t{3} * a_.nodes_per_clock, lane_logic(inputs_, a_, w_, e_), kLane},
        {"row collector", 1, collector(), kCollector},
        {"sums", 1, sums_logic(inputs_, a_, w_, e_), kSums},
        {"divider", 1, divider(), kDivider},
        {"scaler", 1, scaler(), kScaler},
        {"stop test", 1, stop_test(), kStopTest},
        {"sequencer", 1, sequencer(), kSequencer},
        {"editor", 1, editor(), kEditor},
        {"settings", 1, {24, 127 + 2 * e_.node + 1 + w_.matrix_bits}, kSettings},
        {"between", 1, between_logic(inputs_, a_, w_, e_), kBetween}};
    if (!direct()) all.push_back({"banks of d", partitions, dealt_direction(), kBanks});
    if (w_.preconditioned()) all.push_back({"inverse maker", 1, inverse(), kInverse});
    if (a_.matrix_storage == MatrixStorage::symmetric) {
      all.push_back({"transposed products", 1, transposed_products(), 1});
    }
    return all;
  }

 private:
  std::int64_t choose(std::int64_t ways) const { return multiplexer_cells(ways, inputs_); }
  std::int64_t row_turns() const { return ceil_div(3, a_.rows_in_parallel); }
  bool pumped() const { return a_.direction_memory == DirectionMemory::double_pumped; }
  // A port of a memory of d is always the same node's.
  bool direct() const {
    return a_.direction_banks == 1 && e_.package_nodes <= a_.direction_accesses();
  }
  bool one_turn() const { return direct() && row_turns() == 1; }
  // Accesses of a bank in a clock.
  int accesses() const {
    const int lanes = std::max(1, a_.nodes_per_clock / a_.direction_banks);
    return std::max(std::min(e_.package_nodes, a_.direction_accesses()), lanes);
  }

  // spmxv_partition.sv: the sub-block of thesis Fig. 5.5.
  UnitLogic partition() const {
    UnitLogic all = issue();
    add(all, operands());
    if (direct()) add(all, direction());
    const int rows = a_.rows_in_parallel;
    const int pairs = ceil_div(a_.package, 2);
    const int fours = ceil_div(a_.package, 4);
    all.registers += std::int64_t{2} * rows * a_.package * e_.product;
    all.registers +=
        std::int64_t{rows} * (pairs * (e_.product + 1) + fours * (e_.product + 2) + e_.product + 4);
    all.tables += rows * adder_tree_bits(a_.package, e_.product);
    // What goes beside them: the row's node, and the words of d there.
    all.registers += 12 + 6 * e_.node + 18 + 18 * w_.vector_bits + (one_turn() ? 0 : 12);
    all.registers += std::int64_t{3} * e_.package_nodes;  // which node is the row's own
    all.registers += 3 * e_.sum + 3 * w_.vector_bits + e_.queue + 1;
    all.tables += 3 * e_.sum;
    return all;
  }

  // Index words that are read ahead, and counters of packages and rows. Behind the package's first
  // rank there is no need of its nodes.
  UnitLogic issue() const {
    const int index = e_.index + 1 + (one_turn() ? 0 : 2);
    return {2 * e_.index + 5 * e_.package + 2 * (e_.queue + 1) + 15,
            2 * index + e_.index + e_.node + 3 + 3 * e_.package + e_.queue + 10 +
                (row_turns() > 1 ? 4 : 0)};
  }

  // A column's word of d is that of the first, second or third component; a row's turn chooses its
  // words of the matrix; the words at the row's own node are caught.
  UnitLogic operands() const {
    const std::int64_t columns = std::int64_t{a_.package} * w_.vector_bits;
    const std::int64_t matrix = std::int64_t{a_.rows_in_parallel} * a_.package * w_.matrix_bits;
    const std::int64_t own = e_.package_nodes * gate_cells(2 * e_.node, inputs_) +
                             3 * w_.vector_bits * (choose(e_.package_nodes + 1) + 1);
    return {columns * choose(3) + matrix * choose(row_turns()) + own, columns + matrix};
  }

  // The ports of the memories of d: addresses of a product or of a pass, and of both halves of a
  // clock. Each component has its own registers at the ports of a double-pumped memory, and keeps
  // all words that a product reads; behind a crossbar they are chosen before the ports, and the
  // words of the first half are kept.
  UnitLogic direction() const {
    const std::int64_t sets = direct() ? 1 : 3;  // of addresses: one for all components, or each
    const std::int64_t written = std::int64_t{3} * a_.nodes_per_clock * w_.vector_bits;
    const int banks = a_.direction_banks;
    const std::int64_t address = sets * banks * std::int64_t{e_.bank_address};
    if (!pumped()) {
      const int copies = a_.direction_memory == DirectionMemory::two_copies ? 2 : 1;
      return {address * copies * 4, address * copies * 2 + written + 2 * banks};
    }
    if (direct()) {
      const int kept = accesses() > 2 ? 3 * accesses() * w_.vector_bits : 0;
      return {address * 8, address * 8 + written + kept + a_.nodes_per_clock + 9};
    }
    const std::int64_t kept = accesses() > 2 ? std::int64_t{6} * w_.vector_bits * banks : 0;
    return {address * 4, address * 4 + written + kept + a_.nodes_per_clock + 5};
  }

  // Nodes are dealt to banks and turns, each component by itself: ports as above, which read of its
  // bank a node is, addresses to the banks' ports, and words back (bank_reads.sv,
  // direction_copy.sv).
  UnitLogic dealt_direction() const {
    const std::int64_t nodes = e_.package_nodes;
    const std::int64_t ports = std::int64_t{a_.direction_banks} * accesses();
    const bool waits = nodes > a_.direction_accesses();
    const int bank = levels_over(a_.direction_banks);
    const std::int64_t kept = waits ? 3 * nodes * w_.vector_bits : 0;
    const std::int64_t words = 3 * nodes * w_.vector_bits * choose(ports);
    const std::int64_t addresses = 3 * ports * e_.bank_address * gate_cells(2 * nodes, inputs_);
    UnitLogic all = direction();
    all.tables += words + addresses + 2 * nodes * nodes * e_.node + kept;
    all.registers += 2 * nodes * bank + 18 * nodes + kept;
    return all;
  }

  // row_collector.sv: whose turn it is, and the words of all partitions to each lane.
  UnitLogic collector() const {
    const int lanes = a_.nodes_per_clock;
    const std::int64_t row = e_.node + 3 * (e_.sum + w_.vector_bits);
    return {lanes * row * gate_cells(2 * a_.partitions, inputs_) +
                a_.partitions * (3 * (e_.queue + 1) + 10 * (lanes + 1)),
            a_.partitions * (5 + 3 * lanes + 2 * e_.queue + 1) + lanes * (row + 1)};
  }

  // coefficient_divider.sv: a bit of the quotient a clock, both operands shifted to the left.
  UnitLogic divider() const {
    const int scalar = w_.scalar_bits - 1;
    return {7 * scalar + 3 * w_.coefficient_bits + 3 * kExponentBits + 2,
            2 * scalar + 1 + 2 * (w_.coefficient_bits - 1) + levels_over(w_.coefficient_bits - 1) +
                kExponentBits + 12};
  }

  // scaler.sv: a product, two shifts by any distance, and exponents.
  UnitLogic scaler() const {
    const int product = w_.coefficient_bits - 1 + kProductBits - 1;
    const int measured = std::max(product, kTermBits + 3);
    return {10 * measured + 6 * kTermBits + 16 * kExponentBits, 3 * product + measured + 454};
  }

  // stop_test.sv: sums of squares to 53 bits, which are multiplied and compared.
  UnitLogic stop_test() const {
    const int word = std::max(64, 8 * ceil_div(e_.squares, 8));
    return {7 * word + 12 * kMantissaBits + 6 * kExponentBits, e_.squares + word + 452};
  }

  // sequencer.sv without those three: scalars, exponents and shifts.
  UnitLogic sequencer() const {
    return {8 * w_.scalar_bits + 20 * kExponentBits + e_.difference,
            5 * w_.scalar_bits + 249 + 5 * w_.coefficient_bits + (w_.preconditioned() ? 28 : 0)};
  }

  // matrix_editor.sv: a package of any partition, the row that comes back, and the visits.
  UnitLogic editor() const {
    const std::int64_t word = w_.matrix_bits;
    const std::int64_t package = 3 * a_.package * word;
    const std::int64_t nodes = e_.package_nodes;
    const int number = bits_to_number(a_.partitions);
    const int banks = nodes > 4 ? 8 : 4;
    const std::int64_t visits = 7 * e_.node + 7 * kRowBlockBits + 6 * (kRowBlockBits + 3) +
                                8 * e_.package + 7 * number + 130;
    return {(package + e_.index) * choose(a_.partitions) + nodes * 9 * word * choose(banks + 1) +
                5 * package + 3 * word * gate_cells(2 * a_.package, inputs_) + 250 +
                2 * nodes * e_.node,
            18 * word + 3 * package + nodes * (9 * word + 3) + 12 * a_.package + a_.partitions +
                visits + (banks - 1) * (kRowBlockBits - bits_to_number(banks)) - 23};
  }

  // inverse_maker.sv: a serial division, and counters of rows by the length of their word;
  // block_inverse_maker.sv has cofactors and six quotients beside them. Both are linear in the
  // words of the matrix and the nodes' numbers, as syntheses of each of three sizes say.
  UnitLogic inverse() const {
    if (w_.method == fixed::Method::block_jacobi_pcg) {
      return {81 * w_.matrix_bits + 11 * e_.node + 769, 53 * w_.matrix_bits + 2 * e_.node + 429};
    }
    return {13 * w_.matrix_bits + 244, 4 * w_.matrix_bits + 2 * e_.node + 110};
  }

  // Symmetric storage, which engine.sv has not: the other operand of each multiplier, sums over a
  // node's rows and into the partial sums of every column, and the partitions' sums added L nodes
  // at a time.
  UnitLogic transposed_products() const {
    const std::int64_t operands =
        std::int64_t{a_.rows_in_parallel} * a_.package * w_.vector_bits * choose(2);
    const std::int64_t column = adder_tree_bits(a_.rows_in_parallel, e_.product) + e_.sum;
    const std::int64_t sums = a_.partitions * a_.package * column;
    const std::int64_t gathered =
        std::int64_t{3} * a_.nodes_per_clock * adder_tree_bits(a_.partitions, e_.sum);
    return {a_.partitions * operands + sums + gathered, sums + gathered};
  }

  static void add(UnitLogic& all, const UnitLogic& one) {
    all.tables += one.tables;
    all.registers += one.registers;
  }

  int inputs_;
  const Architecture& a_;
  const WordLengths& w_;
  EngineWords e_;
};

}  // namespace

double LogicUse::cells() const { return static_cast<double>(count * counted.tables) * coefficient; }

std::int64_t LogicUse::registers() const { return count * counted.registers; }

std::int64_t multiplexer_cells(std::int64_t ways, int inputs) {
  return ceil_div(ways - 1, ways_of(inputs) - 1);
}

std::int64_t shifter_cells(std::int64_t bits, int select, int inputs) {
  return bits * ceil_div(select, bits_to_number(ways_of(inputs)));
}

std::int64_t gate_cells(std::int64_t operands, int inputs) {
  return ceil_div(operands - 1, inputs - 1);
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
  return EngineLogic(device, a, w, s).take();
}

UnitLogic logic_of_device(const Device& device, const std::vector<LogicUse>& uses) {
  double cells = 0;
  double registers = 0;
  for (const LogicUse& use : uses) {
    cells += use.cells();
    registers += static_cast<double>(use.registers());
  }
  return {std::llround(cells * device.logic.cells_share),
          std::llround(registers * device.logic.registers_share)};
}

}  // namespace hvp::accel
