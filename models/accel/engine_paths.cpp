#include "models/accel/engine_paths.h"

#include <algorithm>

#include "models/accel/bits.h"
#include "models/accel/memory.h"
#include "models/accel/multipliers.h"
#include "models/accel/path_builder.h"

namespace hvp::accel {

namespace {

// Vectors and tables that the host reads beside the matrix memories.
constexpr int kHostMemories = 12;
constexpr int kHostAddressBits = 20;

// The part of the device's multipliers that is in use.
double multiplier_fill(const Device& device, const Architecture& a, const WordLengths& w) {
  const int count = multiplier_mode(device, a).count;
  return count > 0 ? static_cast<double>(multipliers(device, a, w)) / count : 0;
}

class EnginePaths {
 public:
  EnginePaths(const Clocking& c, const std::function<void(const Path&)>& take)
      : device_(c.device),
        a_(c.architecture),
        w_(c.words),
        nodes_(std::max(c.nodes, 2)),
        take_(take),
        multiplier_(multiplier_mode(c.device, c.architecture)),
        path_(*c.device.timing, multiplier_fill(c.device, c.architecture, c.words)) {}

  void all() {
    issue();
    read_direction();
    deal_direction();
    multiply();
    add();
    collect();
    vector_unit();
    divide();
    host();
    block_limits();
  }

 private:
  // The counters of rows decide whether the next package is issued, which is the address of the
  // index memory at once.
  void issue() {
    const int row_bits = bits_of(nodes_);
    take_(path_.begin("issue of a package")
              .from_register()
              .adder(row_bits)
              .gates(row_bits)
              .multiplexer(2)
              .to_memory());
  }

  // Index memory -> address of d -> word of d.
  void read_direction() {
    const bool pumped = a_.direction_memory == DirectionMemory::double_pumped;
    take_(path_.begin("index to the address of d").from_memory(output_register()).to_register());
    path_.begin("address into the memory of d");
    if (pumped) path_.twice_a_clock();
    path_.from_register();
    if (pumped) path_.multiplexer(2);
    take_(path_.to_memory());
    if (!pumped) return;
    take_(path_.begin("word out of the memory of d")
              .twice_a_clock()
              .from_memory(output_register())
              .to_register());
  }

  // Where a port of a memory of d is not always the same node's: nodes to the ports of their banks,
  // and words back (bank_reads.sv, direction_copy.sv).
  void deal_direction() {
    const int nodes = nodes_in_package(a_.package);
    const int accesses = a_.direction_accesses();
    const bool turns = nodes > accesses;
    if (a_.direction_banks == 1 && !turns) return;
    // A node's port is its own where its bank serves it: known before its number is; and in the
    // turn of that number.
    const int port_bits = 2 + levels_over(nodes) + (turns ? 2 : 0);
    take_(path_.begin("node of a package to its bank of d")
              .from_register()
              .gates(2 * bits_of(nodes_))  // is it the node before, whose word serves for both?
              .gates(2 * (nodes - 1))      // how many before it are in its bank
              .multiplexer(nodes)          // the number of the node that it repeats
              .gates(port_bits)
              .gates(2 * nodes)  // a port's node
              .to_register());
    // A double-pumped memory's last words come half a clock before the operands.
    path_.begin("word of d from its bank");
    if (a_.direction_memory == DirectionMemory::double_pumped) path_.twice_a_clock();
    path_.from_memory(output_register())
        .multiplexer(a_.direction_banks * std::min(nodes, accesses));
    if (turns) path_.multiplexer(2);  // or the one of an earlier turn
    take_(path_.multiplexer(3).to_register());
  }

  void multiply() {
    const int bits = std::max(w_.matrix_bits, w_.vector_bits);
    path_.begin("matrix word to its multiplier").from_memory(output_register());
    into_multiplier(bits);
    // A column's word is that of a bank and block, and of one of three components.
    path_.begin("word of d to its multiplier").from_memory(output_register());
    deep_memory(Role::copies, a_.direction_banks);
    path_.multiplexer(3);
    into_multiplier(bits);
    // Sign and magnitude, as in Fig. 5.10, but into the multiplier's own register.
    path_.begin("vector word to its multiplier").from_memory(output_register());
    deep_memory(Role::vectors, 1);
    path_.absolute_value(magnitude_bits(multiplier_, w_));
    into_multiplier(magnitude_bits(multiplier_, w_));
    if (a_.multiplier_clocks == 2) {
      take_(path_.begin("multiplier").multiplier_alone(bits).to_multiplier_output());
    }
  }

  // Adder trees of the sub-blocks and of the vector unit's inner products. Parts of a product that
  // is wider than a multiplier are added first.
  void add() {
    const int bits = w_.matrix_bits + w_.vector_bits;
    const int parts = multipliers_a_product(multiplier_, w_.matrix_bits, w_.vector_bits);
    const int levels = levels_over(parts) + levels_over(a_.package);
    const int sum_bits = bits + kRowGrowthBits;
    tree("adder tree of a row", levels, bits, sum_bits, true);
    tree("sum over the lanes", levels_over(3 * a_.nodes_per_clock), kProductBits + w_.vector_bits,
         w_.scalar_bits, false);
  }

  // A tree over its ranks, and the accumulator behind it, which goes into a memory or a register.
  void tree(std::string_view name, int levels, int bits, int sum_bits, bool into_memory) {
    const int spare = std::max(0, a_.multiplier_clocks - 3);
    const int ranks = a_.adder_tree_clocks - 1 + (into_memory ? spare : 0);
    const int together = ranks > 0 ? ceil_div(levels, ranks) : levels;
    const auto adders = [&](int first, int count) {
      for (int i = 0; i < count; ++i) path_.adder(bits + first + i);
    };
    if (ranks > 0 && levels > 0) {
      path_.begin(name);
      into_memory ? path_.from_multiplier_register() : path_.from_register();
      adders(1, together);
      take_(path_.to_register());
      path_.begin(name).from_register();
      adders(levels - together + 1, together);
      take_(path_.to_register());
    }
    path_.begin(into_memory ? "accumulator of a row" : "accumulator of an inner product");
    path_.from_register();
    if (ranks <= 0) adders(1, levels);
    path_.adder(sum_bits);
    take_(into_memory ? path_.to_memory() : path_.to_register());
  }

  // Rows from the partitions' result memories.
  void collect() {
    const int row_bits = bits_of(nodes_);
    take_(path_.begin("row out of the result memories")
              .from_memory(true)
              .multiplexer(a_.partitions)
              .to_register());
    take_(path_.begin("choice of a result memory")
              .from_register()
              .gates(2 * row_bits)
              .gates(a_.partitions * a_.nodes_per_clock)
              .adder(row_bits)
              .to_register());
  }

  void vector_unit() {
    const int ranks = std::max(1, a_.vector_clocks());
    for (const VectorStages& stages :
         {product_stages(a_, w_, multiplier_), update_stages(a_, w_, multiplier_)}) {
      each_rank(stages, ranks, path_, take_);
    }
    // Dynamic scaling keeps the largest magnitude of what is written.
    take_(path_.begin("magnitude of a written word")
              .from_register()
              .absolute_value(kProductBits)
              .to_register());
    take_(
        path_.begin("largest written word").from_register().comparator(kProductBits).to_register());
  }

  // A bit of the quotient a clock, and the longest steps of the re-scaling behind it
  // (models/fixed/division.h): an adder of 40 bits behind a shifter, with ranks between.
  void divide() {
    constexpr int kAdderBits = 40;
    take_(
        path_.begin("step of a division").from_register().comparator(w_.scalar_bits).to_register());
    take_(path_.begin("rounding of a quotient")
              .from_register()
              .adder(w_.coefficient_bits)
              .multiplexer(2)
              .to_register());
    take_(path_.begin("shift of a re-scaling").from_register().shifter(kAdderBits).to_register());
    take_(path_.begin("sum of a re-scaling").from_register().adder(kAdderBits + 2).to_register());
  }

  void host() {
    take_(path_.begin("host writes a memory")
              .from_register()
              .gates(kHostAddressBits)
              .multiplexer(2)
              .to_memory());
    take_(path_.begin("host reads a memory")
              .from_memory(output_register())
              .multiplexer(a_.rows_in_parallel * a_.partitions + kHostMemories)
              .to_register());
  }

  void block_limits() {
    if (a_.multiplier_clocks >= 2) {
      take_(path_.begin("multiplier block").block(multiplier_.clock_hz));
    }
    memory_limit("memory block of d", Role::copies);
    memory_limit("memory block of the matrix", Role::matrix);
    memory_limit("memory block of the index", Role::index);
    memory_limit("memory block of a vector", Role::vectors);
    memory_limit("memory block of the results", Role::queue);
  }

  void memory_limit(std::string_view name, Role role) {
    path_.begin(name);
    const bool pumped = a_.direction_memory == DirectionMemory::double_pumped;
    if (role == Role::copies && pumped) path_.twice_a_clock();
    take_(path_.block(memory_for(device_, a_, role).clock_hz));
  }

  bool output_register() const { return a_.memory_read_clocks >= 2; }

  // Blocks of a component's memory are chosen from; a third clock of reading is a register there.
  void deep_memory(Role role, int banks) {
    const MemoryType& memory = memory_for(device_, a_, role);
    const int width = memory.two_port_bits > 0 ? memory.two_port_bits : memory.read_write_bits;
    const int words = std::max(1, memory.bits / width);
    path_.multiplexer(banks * ceil_div(ceil_div(nodes_, banks), words));
    if (a_.memory_read_clocks < 3) return;
    const std::string_view name = path_.name();
    take_(path_.to_register());
    path_.begin(name).from_register();
  }

  void into_multiplier(int bits) {
    if (a_.multiplier_clocks >= 2) {
      take_(path_.to_multiplier());
    } else {
      take_(path_.multiplier(bits).to_multiplier_output());
    }
  }

  const Device& device_;
  const Architecture& a_;
  const WordLengths& w_;
  int nodes_;
  const std::function<void(const Path&)>& take_;
  const MultiplierMode& multiplier_;
  PathBuilder path_;
};

}  // namespace

void each_path(const Clocking& c, const std::function<void(const Path&)>& take) {
  EnginePaths(c, take).all();
}

}  // namespace hvp::accel
