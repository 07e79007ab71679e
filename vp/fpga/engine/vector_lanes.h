#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "models/fixed/reference_machine.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "models/fixed/types.h"
#include "models/fixed/word.h"
#include "vp/fpga/engine/word_shifter.h"

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

// What the lanes make words of, three words a node: the memories themselves, or what the ranks have
// carried since they were read.
struct LaneWords {
  const std::int32_t* x = nullptr;
  const std::int32_t* b = nullptr;
  const std::int32_t* r = nullptr;
  const std::int32_t* z = nullptr;
  const std::int32_t* q = nullptr;
  const std::int32_t* previous = nullptr;
  const std::int32_t* d = nullptr;        // as it is multiplied
  const std::int32_t* kept_d = nullptr;   // as an exchange writes it
  const std::int32_t* inverse = nullptr;  // nine words a node
  std::int32_t* new_z = nullptr;          // where z goes
  // α or β before d and before q: they are multiplied at different edges.
  std::int32_t of_d = 0;
  std::int32_t of_q = 0;
};

// A word as the lanes multiply it, by its magnitude of a bit less: the one word that has no
// negative, which nothing but a flip makes, counts as zero.
constexpr std::int32_t multiplied(std::int32_t word, int bits) {
  return word == -fixed::word_limit(bits) - 1 ? 0 : word;
}

// The vectors' memories and the lanes' arithmetic, without clocks: what a pass makes of the words
// of a node. All of a node's arithmetic is done when its words are written. Until then nobody
// writes the words that its lane has read, so that none has to be carried through the ranks, but
// where bits of the memories flip.
class VectorLanes {
 public:
  VectorMemories& memories() { return memories_; }
  const VectorMemories& memories() const { return memories_; }
  const fixed::Settings& settings() const { return settings_; }

  void load(int nodes);
  // Sets the words and rules of the next jobs.
  void configure(const fixed::Settings& settings, int inverse_shift);
  // The clamped and wrapped words and the flags since it was cleared.
  fixed::Report& report() { return report_; }

  // Begins a pass, with no sums yet.
  void begin(const VectorCommand& command);
  const VectorCommand& command() const { return now_; }
  // From now on a term of a sum is cut at the aligners' longest word: only where a bit of an
  // exponent has flipped both terms can be beyond every word.
  void cut_terms() { cuts_terms_ = true; }
  void shift_z(int shift) {
    now_.z_shift = shift;
    z_shift_ = WordShifter(shift, settings_.shift_rounding);
  }
  // The mantissa that the pass multiplies by.
  std::int32_t& coefficient() { return now_.pass == Pass::direction ? now_.beta : now_.alpha; }
  // The pass' sums over the words written so far.
  const VectorStatus& status() const { return status_; }

  // The words of the nodes from this one on as they stand in the memories, with these of d.
  LaneWords words(int first_node, const std::int32_t* direction);
  // Every pass but copy and product: writes `nodes` nodes from `first_node` on, made of their words
  // `from`; `written` gets those for the copies of d if the pass makes such.
  void write(int first_node, int nodes, const LaneWords& from, std::int32_t* written);
  // The product: the words of q from the exact sums of a node's rows, rounded and clamped once, and
  // its part of the pass' sums. `own` has the node's words of the multiplied vector.
  std::array<std::int32_t, 3> round_product(int node, const std::array<std::int64_t, 3>& sum,
                                            const std::array<std::int32_t, 3>& own);
  // What a row adds to a product's sums, where it has its clocks.
  struct RowPart {
    fixed::Int128 dot = 0;
    fixed::Int128 squares = 0;
    std::uint64_t widest = 0;
  };
  // The same without the row's part of the sums, which it returns.
  RowPart round_row(int node, const std::array<std::int64_t, 3>& sum,
                    const std::array<std::int32_t, 3>& own, std::array<std::int32_t, 3>& q);
  void add_dot(const RowPart& row) { status_.dot += row.dot; }
  void add_squares(const RowPart& row) { status_.squares += row.squares; }
  void add_widest(const RowPart& row) { status_.widest = std::max(status_.widest, row.widest); }

 private:
  // Nearly every value has room in its word.
  std::int32_t clamped(std::int64_t value, int bits) {
    const std::int64_t limit = fixed::word_limit(bits);
    if (value <= limit && value >= -limit) [[likely]]
      return static_cast<std::int32_t>(value);
    return machine_.write(value, bits);
  }
  void write_guess(std::size_t first, std::size_t count, const LaneWords& from,
                   std::int32_t* written);
  void write_residual(std::size_t first, std::size_t count, const LaneWords& from,
                      std::int32_t* written);
  void write_update(std::size_t first, std::size_t count, const LaneWords& from,
                    std::int32_t* written);
  void write_direction(std::size_t count, const LaneWords& from, std::int32_t* written);
  std::int64_t cut(std::int64_t term) const {
    return term_limit_ == 0 ? term : std::clamp(term, -term_limit_, term_limit_);
  }
  void precondition(std::size_t first, std::size_t count, const LaneWords& from);

  VectorMemories memories_;
  fixed::Settings settings_;
  int inverse_shift_ = 0;
  bool cuts_terms_ = false;
  std::int64_t term_limit_ = 0;  // 0: none
  fixed::Report report_;
  fixed::ReferenceMachine machine_{settings_, report_};  // the rules of the words
  fixed::Report uncounted_;
  fixed::ReferenceMachine silent_{settings_, uncounted_};

  VectorCommand now_;
  VectorStatus status_;
  std::vector<std::int32_t> before_;  // of a guess: the words of the solution before x
  WordShifter x_shift_, r_shift_, change_shift_, z_shift_, d_shift_, product_shift_;
  WordShifter preconditioner_shift_;
};

}  // namespace hvp::vp::engine
