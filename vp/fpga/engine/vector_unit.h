#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <systemc>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/reference_machine.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "models/fixed/types.h"
#include "vp/fpga/engine/engine_clock.h"
#include "vp/fpga/engine/spmxv_block.h"

namespace hvp::vp::engine {

// The passes of the vector unit over all nodes. The groups are those of thesis Fig. 4.4.
enum class Pass {
  none,
  copy,             // x into the copies of d
  guess,            // the same with x on the line through the last two solutions
  product,          // group a: rows that the SpMxV blocks finish become q, and dᵀq
  residual,         // r = b − q and z = P⁻¹·r, rᵀr or zᵀr
  first_direction,  // d = z
  update,           // group b: x, r, z and zᵀr
  direction,        // group c: d = z + β·d
};

// A command from the sequencer, which does not change while a pass runs.
struct VectorCommand {
  std::uint32_t number = 0;  // every change starts a pass
  Pass pass = Pass::none;
  bool hold = false;     // nothing is written: the solve is over, its passes are not
  bool compare = false;  // product: also the size of b − q
  bool first = false;    // residual: clamped words of b are counted
  bool zero = false;     // start from zero: rows count as zero, and the residual clears x
  bool alone = false;    // guess: no solution lies before x
  // x and the copies of d are exchanged, for a product with x amid the iterations.
  bool exchange = false;
  std::int32_t alpha = 0;  // mantissas
  std::int32_t beta = 0;
  int x_shift = 0;       // of α·d, to units of x
  int r_shift = 0;       // of r to its new exponent; residual: of b − q
  int change_shift = 0;  // of α·q, to units of the new r
  int z_shift = 0;       // of z, to units of the new d
  int d_shift = 0;       // of β·d, to units of the new d
};

// The status for the sequencer at the end of a pass.
struct VectorStatus {
  std::uint32_t number = 0;     // the command's
  fixed::Int128 dot = 0;        // product: dᵀq; residual, update: zᵀr. Exact
  fixed::Int128 squares = 0;    // rᵀr; product with compare: bᵀb. Exact
  std::uint64_t largest_r = 0;  // magnitudes of what was written
  std::uint64_t largest_z = 0;
  std::uint64_t largest_d = 0;
  std::uint64_t largest_q = 0;
  std::uint64_t widest = 0;  // product with compare: |b − q|
};

// The vectors except d, each in L memories with a read and a write port; a node is in memory node
// mod L. Three words for each node.
struct VectorMemories {
  std::vector<std::int32_t> x, b, r, z, q;
  std::vector<std::int32_t> previous;  // x before the last job, for an extrapolated start
  std::vector<std::int32_t> inverse;   // P⁻¹, nine words a node
};

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

  VectorMemories& memories() { return memories_; }
  const VectorMemories& memories() const { return memories_; }

  // A host access, while idle.
  void load(int nodes);
  void clocked();
  // Empties the lanes.
  void reset();
  // Sets the words and rules of the next jobs.
  void configure(const fixed::Settings& settings, int inverse_shift);
  // The clamped and wrapped words and the flags since it was cleared.
  fixed::Report& report() { return report_; }

  // For traces.
  int position() const { return next_node_; }
  Pass pass() const { return running_ ? now_.pass : Pass::none; }
  // The node whose words lane 0 wrote last.
  int written_node() const { return written_node_; }

 private:
  // A group of nodes in the lanes.
  struct Group {
    int first = 0;
    int count = 0;
  };
  // A lane's registers.
  struct Lane {
    std::array<std::int32_t, 3> x{}, previous{}, d{}, r{}, q{}, b{}, z{};
    std::array<std::int64_t, 3> alpha_d{}, alpha_q{}, beta_d{};
  };

  void begin_pass();
  void move_lanes();
  void enter_group(int accesses);
  void read(const Group& group, Lane* lanes);
  void multiply(const Group& group, Lane* lanes) const;
  void align_and_write(const Group& group, Lane* lanes);
  void sum(const Group& group, const Lane* lanes);
  void finish_pass();

  void write_copy(const Lane& lane, std::int32_t* direction) const;
  void write_guess(int node, const Lane& lane, std::int32_t* direction);
  void write_residual(int node, Lane& lane, std::int32_t* direction);
  void write_update(int node, Lane& lane, std::int32_t* direction);
  void write_direction_word(Lane& lane, std::int32_t* direction);
  void precondition(int node, Lane& lane);

  void collect();
  void write_back(int age);
  int take(std::size_t block);

  bool reads_direction() const;
  bool writes_direction() const;
  int accesses(int nodes, int each) const;

  const accel::Architecture& architecture_;
  std::vector<std::unique_ptr<SpmxvBlock>>& blocks_;
  VectorMemories memories_;
  fixed::Settings settings_;
  fixed::Report report_;
  fixed::ReferenceMachine machine_{settings_, report_};  // the rules of the words
  fixed::Report uncounted_;
  fixed::ReferenceMachine silent_{settings_, uncounted_};
  int nodes_ = 0;
  int inverse_shift_ = 0;

  VectorCommand now_;
  VectorStatus sums_;
  bool running_ = false;
  int next_node_ = 0;   // of the group that enters next
  int done_nodes_ = 0;  // summed, or written back
  int reads_left_ = 0;  // accesses to d that the entering group still needs
  int writes_left_ = 0;

  Ranks ranks_;
  std::vector<Group> group_;
  std::vector<Lane> lane_;  // L a slot

  // The rows between the result memories and q, up to L in a slot.
  Ranks back_ranks_;
  std::vector<int> back_count_;
  std::vector<RowResult> back_row_;
  std::vector<std::uint32_t> taken_;
  std::size_t first_block_ = 0;  // the block whose turn it is
  std::vector<std::uint8_t> bank_written_;
  std::vector<std::int32_t> direction_words_;
  int written_node_ = 0;
};

}  // namespace hvp::vp::engine
