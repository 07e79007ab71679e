#include "vp/fpga/rtl/rtl_spmxv.h"

#include <cstddef>

// Verilator's headers take SystemC's clock for theirs and expect its name here.
using sc_core::sc_time_stamp;

#include <Vspmxv.h>
#include <verilated.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::vp::rtl {

namespace {

// The parameters of spmxv.sv.
constexpr int kColumns = 8;
constexpr int kNodes = 4;
constexpr int kLanes = 2;
constexpr int kVectorBits = 16;
constexpr int kSumBits = 48;
constexpr int kNodeBits = 10;
constexpr int kPackageBits = 11;
constexpr std::uint64_t kWordMask = (std::uint64_t{1} << kVectorBits) - 1;

std::int64_t sign_extended(std::uint64_t value, int bits) {
  const int unused = 64 - bits;
  return static_cast<std::int64_t>(value << unused) >> unused;
}

// Bits [first, first + width) of a wide port.
template <class Port>
std::uint64_t field(const Port& words, int first, int width) {
  std::uint64_t value = 0;
  for (int bit = 0; bit < width; ++bit) {
    const int position = first + bit;
    const std::uint64_t one = (words[at(position / 32)] >> (position % 32)) & 1U;
    value |= one << bit;
  }
  return value;
}

void require(bool same, const char* key, const char* expected) {
  if (same) return;
  throw InputError(key, std::string("the RTL sub-block is written for ") + expected);
}

void require_fitting(const accel::Architecture& a) {
  const accel::Architecture thesis;
  require(a.package == kColumns, "package", "8");
  require(a.rows_in_parallel == 3, "rows_in_parallel", "3");
  require(a.packages_per_row == 0, "packages_per_row", "0");
  require(a.memory_read_clocks == thesis.memory_read_clocks, "memory_read_clocks", "2");
  require(a.multiplier_clocks == thesis.multiplier_clocks, "multiplier_clocks", "3");
  require(a.adder_tree_clocks == thesis.adder_tree_clocks, "adder_tree_clocks", "4");
  require(a.result_queue == thesis.result_queue, "result_queue", "16");
  require(a.nodes_per_clock <= kLanes, "nodes_per_clock", "1 or 2");
  require(a.direction_memory == accel::DirectionMemory::double_pumped, "direction_memory",
          "\"double-pumped\"");
}

}  // namespace

RtlSpmxv::RtlSpmxv(const sc_core::sc_module_name& name, engine::CycleEngine& engine, int partition)
    : sc_module(name),
      engine_(engine),
      partition_(partition),
      context_((require_fitting(engine.architecture()), std::make_unique<VerilatedContext>())),
      rtl_(std::make_unique<Vspmxv>(context_.get())) {
  SC_HAS_PROCESS(RtlSpmxv);
  SC_METHOD(clocked);
  sensitive << engine.clock().edge();
  dont_initialize();
}

RtlSpmxv::~RtlSpmxv() { rtl_->final(); }

void RtlSpmxv::edge() {
  rtl_->clock = 0;
  rtl_->eval();
  rtl_->clock = 1;
  rtl_->eval();
}

void RtlSpmxv::load() {
  const engine::SpmxvBlock& block = engine_.block(partition_);
  const engine::Partition& partition = block.partition();
  require(partition.packages() < 1 << kPackageBits, "partitions", "fewer than 2048 packages");
  require(engine_.layout().nodes() <= 1 << kNodeBits, "nodes", "1024 nodes at most");
  rtl_->start = 0;
  rtl_->direction_count = 0;
  rtl_->taken = 0;
  rtl_->packages = static_cast<std::uint16_t>(partition.packages());
  for (int package = 0; package < partition.packages(); ++package) {
    rtl_->host_package = static_cast<std::uint16_t>(package);
    std::uint64_t nodes = 0;
    for (int n = 0; n < kNodes; ++n) {
      nodes |= static_cast<std::uint64_t>(partition.node[at(package * kNodes + n)])
               << (kNodeBits * n);
    }
    rtl_->host_nodes = nodes;
    rtl_->host_owner = static_cast<std::uint16_t>(partition.owner[at(package)]);
    rtl_->host_phase = partition.phase[at(package)];
    rtl_->host_columns = partition.columns[at(package)];
    rtl_->host_last = partition.last[at(package)];
    rtl_->index_write = 1;
    const auto words = block.package_words(package);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        rtl_->nonzero_write = 1;
        rtl_->host_row = static_cast<std::uint8_t>(row);
        rtl_->host_column = static_cast<std::uint8_t>(column);
        rtl_->host_word = static_cast<std::uint16_t>(words[at(row * kColumns + column)] & 0xfff);
        edge();
        rtl_->index_write = 0;
      }
    }
  }
  rtl_->nonzero_write = 0;
  rtl_->reset = 1;
  edge();
  rtl_->reset = 0;
  edge();  // the index memory's output register has the first package
  started_ = block.start->read();
  written_ = block.direction_write->read().number;
  shown_rows_ = 0;
}

// Inputs are what the engine's registers hold before the edge, for both.
void RtlSpmxv::clocked() {
  const engine::SpmxvBlock& block = engine_.block(partition_);
  compare();
  rtl_->start = block.start->read() != started_ && block.partition().packages() > 0 ? 1 : 0;
  started_ = block.start->read();
  rtl_->taken = block.taken->read();
  const engine::DirectionWrite& write = block.direction_write->read();
  rtl_->direction_count = 0;
  if (write.number != written_) {
    written_ = write.number;
    rtl_->direction_count = static_cast<std::uint8_t>(write.count);
    rtl_->direction_first = static_cast<std::uint16_t>(write.first);
    for (int i = 0; i < 3 * kLanes; i += 2) {
      const auto word = [&](int k) {
        return k < 3 * write.count ? static_cast<std::uint32_t>(write.words[k]) & kWordMask : 0U;
      };
      rtl_->direction_words[at(i / 2)] =
          static_cast<std::uint32_t>(word(i) | word(i + 1) << kVectorBits);
    }
  }
  edge();
  ++edges_;
}

// Compares the outputs of both after the edge before.
void RtlSpmxv::compare() {
  const engine::SpmxvBlock& block = engine_.block(partition_);
  const std::uint32_t finished = block.finished.read();
  if (rtl_->finished != finished) differs("finished", rtl_->finished, finished);
  const std::uint32_t taken = rtl_->taken;  // the row that was shown since the edge before
  if (taken == finished || (shown_rows_ == taken + 1)) return;
  shown_rows_ = taken + 1;
  ++rows_;
  const engine::RowResult& row = block.result(taken);
  if (rtl_->result_node != row.node) differs("result_node", rtl_->result_node, row.node);
  for (int r = 0; r < 3; ++r) {
    const std::int64_t sum =
        sign_extended(field(rtl_->result_sum, kSumBits * r, kSumBits), kSumBits);
    if (sum != row.sum[at(r)]) differs("result_sum", sum, row.sum[at(r)]);
    const std::int64_t own =
        sign_extended((rtl_->result_own >> (kVectorBits * r)) & kWordMask, kVectorBits);
    if (own != row.own[at(r)]) differs("result_own", own, row.own[at(r)]);
  }
}

void RtlSpmxv::differs(const char* output, std::int64_t rtl, std::int64_t model) {
  if (!difference_.empty()) return;
  difference_ = "edge " + std::to_string(edges_) + ": " + output + " is " + std::to_string(rtl) +
                " in RTL, " + std::to_string(model) + " in the model";
}

}  // namespace hvp::vp::rtl
