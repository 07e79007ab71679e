#include "models/accel/board.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "models/accel/fit.h"
#include "models/config/input_error.h"

namespace hvp::accel {

BoardClocks::BoardClocks(const Architecture& a, Pattern p)
    : architecture_(a), pattern_(std::move(p)), units_(unit_clocks(a, pattern_)) {
  if (a.several) several_.emplace(a, pattern_);
}

SolveCycles BoardClocks::solve(const SolveWork& work) const {
  if (several_) return several_->solve(work).solve;
  return solve_cycles(passes_of(architecture_, units_, work), work);
}

std::int64_t BoardClocks::node_update(int node, std::span<const int> neighbours,
                                      const fixed::Settings& settings) const {
  if (several_) return several_->node_update(pattern_, node, neighbours, settings);
  return node_update_cycles(architecture_, pattern_, node, neighbours, settings);
}

std::int64_t BoardClocks::load(const fixed::Settings& settings) const {
  if (several_) return several_->load(pattern_, settings);
  return load_cycles(architecture_, pattern_, settings);
}

namespace {

constexpr int kMostDevices = 8;  // a scenario's

// The scarcest resource's use; beyond one it does not fit.
double fullness(const Usage& usage) {
  if (!usage.obstacles.empty()) return std::numeric_limits<double>::infinity();
  double most = 0;
  for (const Resource& r : usage.resources) {
    if (r.used > 0) most = std::max(most, static_cast<double>(r.used) / std::max(r.available, 1));
  }
  return most;
}

struct Fullest {
  std::size_t device = 0;
  Usage usage;
};

Fullest fullest(const Device& device, const Architecture& a, const WordLengths& words,
                const SeveralDevices& several) {
  Fullest found;
  for (std::size_t d = 0; d < several.shares().size(); ++d) {
    Usage own = usage(device, a, words, several.shares()[d].pattern);
    if (d == 0 || fullness(own) > fullness(found.usage)) found = {d, std::move(own)};
  }
  return found;
}

}  // namespace

Usage board_usage(const Device& device, const Architecture& a, const WordLengths& words,
                  const BoardClocks& board) {
  if (!board.several()) return usage(device, a, words, board.pattern());
  return fullest(device, a, words, *board.several()).usage;
}

int largest_mesh_of_board(const Device& device, const Architecture& a, const WordLengths& words,
                          const BoardClocks& board) {
  if (!board.several()) return largest_mesh(device, a, words, board.pattern());
  const std::size_t worst = fullest(device, a, words, *board.several()).device;
  const Pattern& share = board.several()->shares()[worst].pattern;
  const std::int64_t fitting = largest_mesh(device, a, words, share);
  return static_cast<int>(fitting * board.pattern().nodes() / std::max(share.nodes(), 1));
}

int devices_that_would_do(const Device& device, const Architecture& a, const WordLengths& words,
                          const Pattern& p) {
  if (a.matrix_storage == MatrixStorage::symmetric) return 0;  // one device alone has it
  Architecture more = a;
  if (!more.several) more.several.emplace();
  const int most = std::min(kMostDevices, p.nodes());
  for (int devices = a.several ? a.several->devices + 1 : 2; devices <= most; ++devices) {
    more.several->devices = devices;
    if (fullest(device, more, words, SeveralDevices(more, p)).usage.fits()) return devices;
  }
  return 0;
}

void require_board_fit(const Device& device, const Architecture& a, const WordLengths& words,
                       const BoardClocks& board, std::span<const Device* const> others,
                       int mesh_nodes) {
  std::string where;
  try {
    if (!board.several()) {
      require_fit(device, a, words, board.pattern(), others, mesh_nodes);
    } else {
      const Fullest worst = fullest(device, a, words, *board.several());
      const auto& shares = board.several()->shares();
      where = "device " + std::to_string(worst.device + 1) + " of " +
              std::to_string(shares.size()) + ", with " +
              std::to_string(shares[worst.device].pattern.nodes()) + " of " +
              std::to_string(board.pattern().nodes()) + " nodes: ";
      require_fit(device, a, words, shares[worst.device].pattern, others, mesh_nodes);
    }
  } catch (const InputError& e) {
    const int devices = devices_that_would_do(device, a, words, board.pattern());
    std::string more;
    if (devices > 0)
      more = ", or accelerator.several.devices = " + std::to_string(devices) + " (loosely-timed)";
    throw InputError(e.key(), where + e.what() + more);
  }
}

}  // namespace hvp::accel
