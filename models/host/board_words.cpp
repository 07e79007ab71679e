#include "models/host/board_words.h"

#include <algorithm>

#include "models/host/costs.h"

namespace hvp::host {

namespace {
// At the beginning of a touch, displacements are smaller than the words' unit, which is no fault.
// After this many such frames in a row the words are too coarse.
constexpr int kFramesWithoutWords = 16;
}  // namespace

BoardWords::BoardWords(const fem::ContactConstraint& constraint, const BoardSystem& board,
                       std::span<const double> initial, fem::Effort effort)
    : constraint_(constraint),
      board_(board),
      effort_(effort),
      b_(initial.size()),
      u_(initial.begin(), initial.end()) {}

void BoardWords::begin(std::span<const double> f, const fem::Hold& hold) {
  f_ = f;
  hold_ = hold;
  sent_ = false;
  flags_ = {};
  clamped_ = 0;
}

void BoardWords::go_on(std::span<const double> f, double /*way*/) {
  f_ = f;
  sent_ = false;
}

bool BoardWords::next(std::span<std::int32_t> b) {
  next_operations_ = 0;
  if (sent_) return false;
  sent_ = true;
  next_operations_ = conversion();
  if (hold_.present()) next_operations_ += constraint_.modified_rhs_flops(hold_.nodes);
  if (effort_ == fem::Effort::counted) return true;
  if (hold_.present()) {
    constraint_.modified_rhs(f_, hold_.nodes, hold_.displacement, b_);
    // The board has the diagonal as a word; the right-hand side has to belong to that word for
    // the solution to be u: word · scale · u = s·b with u/s for u in a scaled system.
    const double diagonal = board_.diagonal_word() * board_.matrix().scale;
    for (std::size_t n = 0; n < hold_.nodes.size(); ++n) {
      for (int i = 0; i < 3; ++i) {
        const auto row = static_cast<std::size_t>(3 * hold_.nodes[n] + i);
        b_[row] = diagonal / (board_.words().scale[row] * board_.words().scale[row]) *
                  hold_.displacement[n][i];
      }
    }
  } else {
    std::ranges::copy(f_, b_.begin());
  }
  clamped_ = board_.scaling().right_hand_side(b_, b);
  if (clamped_ > 0) flags_.raise(stability::Flag::range_exceeded);
  look_for_words(b);
  return true;
}

// Where the words are too coarse the load vanishes: the board solves A·x = 0 without a flag.
void BoardWords::look_for_words(std::span<const std::int32_t> b) {
  const bool displaced = std::ranges::any_of(
      hold_.displacement, [](const Eigen::Vector3d& u) { return u.squaredNorm() > 0; });
  vanished_ = displaced && std::ranges::all_of(b, [](std::int32_t word) { return word == 0; });
}

// The displacements of contact nodes are known more exactly than the board's words state them.
void BoardWords::accept(std::span<const std::int32_t> x, stability::Flags flags) {
  flags_.merge(flags);
  if (effort_ == fem::Effort::counted) return;
  frames_without_words_ = vanished_ ? frames_without_words_ + 1 : 0;
  if (frames_without_words_ >= kFramesWithoutWords) flags_.raise(stability::Flag::stagnation);
  board_.scaling().displacements(x, u_);
  if (hold_.elapsed_s == 0) return;
  for (std::size_t n = 0; n < hold_.nodes.size(); ++n) {
    for (int i = 0; i < 3; ++i) {
      u_[static_cast<std::size_t>(3 * hold_.nodes[n] + i)] = hold_.displacement[n][i];
    }
  }
}

// One operation more per word, where every equation has a scale of its own.
double BoardWords::conversion() const {
  const int rows = board_.matrix().block_rows() * 3;
  const bool scaled = board_.words().settings.matrix_scaling != fixed::MatrixScaling::none;
  return conversion_operations(rows) + (scaled ? rows : 0);
}

std::vector<Step> BoardWords::steps() const {
  return {{"form b (without contact)", Step::Where::host, conversion()}, {"", Step::Where::board}};
}

}  // namespace hvp::host
