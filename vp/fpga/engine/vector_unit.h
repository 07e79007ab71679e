#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <systemc>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "vp/fpga/engine/engine_clock.h"
#include "vp/fpga/engine/spmxv_block.h"
#include "vp/fpga/engine/vector_lanes.h"

namespace hvp::vp::engine {

// The vector unit: L lanes of one node each. A group of L nodes is read (memory_read_clocks),
// multiplied by α or β (multiplier_clocks), aligned, added, clamped, written and multiplied by P⁻¹
// and for the inner product (vector_clocks), and summed (adder_tree_clocks). Rows from the SpMxV
// blocks enter behind the multipliers and are q and part of dᵀq vector_clocks later.
//
// Reads and writes of d share the ports of its banks: writes come first, and stall the lanes if
// they take more than a clock.
class VectorUnit : public sc_core::sc_module {
 public:
  VectorUnit(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
             std::vector<std::unique_ptr<SpmxvBlock>>& blocks);

  const Register<VectorCommand>* command = nullptr;
  Register<VectorStatus> status;
  // To the SpMxV blocks: a counter of results taken for each, and the nodes to be written into the
  // copies of d.
  std::vector<std::unique_ptr<Register<std::uint32_t>>> taken;
  Register<DirectionWrite> direction_write;

  VectorMemories& memories() { return lanes_.memories(); }
  const VectorMemories& memories() const { return lanes_.memories(); }

  // A host access, while idle.
  void load(int nodes);
  void clocked();
  // Empties the lanes.
  void reset();
  // Sets the words and rules of the next jobs.
  void configure(const fixed::Settings& settings, int inverse_shift) {
    lanes_.configure(settings, inverse_shift);
  }
  // The clamped and wrapped words and the flags since it was cleared.
  fixed::Report& report() { return lanes_.report(); }
  // From now on the ranks carry their words, since bits of the memories may flip; z
  // is written `late` clocks behind r. To be called
  // while no solve runs.
  void carry_words(int late);
  // Flips a bit of the coefficient as the pass that runs multiplies by it.
  void flip_coefficient(int bit) { lanes_.coefficient() ^= std::int32_t{1} << bit; }
  // The pass that runs aligns z by another shift.
  void shift_z(int shift) { lanes_.shift_z(shift); }
  std::uint32_t pass_number() const { return lanes_.command().number; }

  // Where words are carried, what the blocks see at this edge: whether a product runs, and the node
  // that a pass has read of d, which a pass' end leaves behind the last one.
  bool multiplies() const { return multiplies_; }
  // A product was over with the edge before: the blocks drop what it leaves.
  bool product_ended() const { return product_ended_; }
  int addressed() const { return addressed_; }

  // For traces.
  int position() const { return next_node_; }
  Pass pass() const { return running_ ? lanes_.command().pass : Pass::none; }
  // The node whose words were written last, of several the one in the first lane.
  int written_node() const { return written_node_; }

 private:
  // A group of nodes in the lanes.
  struct Group {
    int first = 0;
    int count = 0;
  };
  // A block's result memory as it is read.
  struct Results {
    std::uint32_t taken = 0;
    std::size_t place = 0;
  };
  // A node's words of q on their way to the memory.
  struct ProductWords {
    int node = 0;
    std::array<std::int32_t, 3> q{};
    // Where words are carried, what q is made of with the row's words of b, and what it adds.
    std::array<std::int64_t, 3> sum{};
    std::array<std::int32_t, 3> own{};
    VectorLanes::RowPart part;
  };
  // What a group's lanes have read: kVectors vectors of three words a node.
  static constexpr std::size_t kVectors = 8;
  struct Carried {
    std::int32_t of_d = 0;
    std::int32_t of_q = 0;
  };

  void begin_pass();
  void move_lanes();
  void enter_group(int accesses_left);
  bool carries() const;
  void carry();
  std::int32_t* carried(std::size_t slot, std::size_t vector);
  LaneWords carried_words(std::size_t slot);
  void write(std::size_t slot);
  void finish_pass();

  void collect();
  bool has_row(std::size_t block) const;
  bool take(std::size_t block);
  void carry_rows();
  void round_rows(int rank);
  void drain_rows();
  void forget_rows();
  std::span<ProductWords> rows_at(int rank);
  void address(bool starts);
  void send_z(const Group& group, const LaneWords& from);
  void write_z();
  void write_back();
  int bank(int node) const;

  int accesses(int nodes, int each) const;

  const accel::Architecture& architecture_;
  std::vector<std::unique_ptr<SpmxvBlock>>& blocks_;
  VectorLanes lanes_;
  int nodes_ = 0;

  bool running_ = false;
  bool ended_ = false;  // the pass, at this edge
  bool product_ended_ = false;
  bool reads_direction_ = false;  // the pass does
  bool writes_direction_ = false;
  int next_node_ = 0;   // of the group that enters next
  int done_nodes_ = 0;  // summed, or written back
  int reads_left_ = 0;  // accesses to d that the entering group still needs
  int writes_left_ = 0;

  Ranks ranks_;
  std::vector<Group> group_;
  // Of a copy the words of x, which the host may write while they pass; of a guess; and of all
  // passes where bits of the memories may flip.
  bool carries_words_ = false;
  std::vector<std::int32_t> carried_;
  std::vector<std::int32_t> carried_inverse_;  // nine words a node
  // Words of z on their way to the memory.
  struct LateWords {
    int left = 0;  // edges
    int first = 0;
    std::vector<std::int32_t> words;
  };
  int late_ = 0;
  std::deque<LateWords> late_z_;
  std::vector<Carried> coefficients_;
  bool multiplies_ = false;
  int addressed_ = 0;
  int address_ = 0;       // with the next edge
  int next_address_ = 0;  // of the group that enters next

  // The rows between the result memories and q, up to L in a slot.
  Ranks back_ranks_;
  std::vector<int> back_count_;
  std::vector<ProductWords> back_words_;
  std::vector<Results> results_;
  std::size_t first_block_ = 0;  // the block whose turn it is
  std::vector<int> bank_;        // of q, for each node; none for those beyond the system
  std::vector<std::uint8_t> bank_written_;
  std::vector<std::int32_t> direction_words_;
  int written_node_ = 0;
};

}  // namespace hvp::vp::engine
