#include "tables/hard_cases/cost.h"

#include <memory>
#include <vector>

#include "app/devices/devices.h"
#include "models/accel/cycles.h"
#include "models/accel/memory.h"
#include "models/fixed/system.h"
#include "models/host/board_words.h"
#include "models/host/costs.h"
#include "models/host/refinement.h"
#include "models/link/pci.h"

namespace hvp::tables {

namespace {

constexpr double kUsPerPs = 1e-6;

std::int64_t bytes_of(int words, int bits) { return (std::int64_t{words} * bits + 31) / 32 * 4; }

std::string smallest_device(const accel::WordLengths& words, const accel::Pattern& pattern) {
  std::string shortage;
  for (const char* name : {"EP2S60", "EP2S180"}) {
    const accel::Usage usage = accel::usage(devices::built_in(name), {}, words, pattern);
    if (usage.fits()) return name;
    shortage.clear();
    for (const accel::Resource& r : usage.resources) {
      if (r.used <= r.available) continue;
      shortage += (shortage.empty() ? "" : ", ") + r.type + " " + std::to_string(r.used) + " of " +
                  std::to_string(r.available);
    }
  }
  return "none: " + shortage;
}

// The host's operations around the board's solves. The force without contact is the conversion of
// U.
double host_operations(const sparse::BlockMatrix& matrix, const fixed::Plan& plan) {
  const std::vector<double> initial(static_cast<std::size_t>(matrix.rows()));
  const fem::ContactConstraint constraint(matrix, fem::ContactDiagonal::average);
  const host::BoardSystem board(matrix, plan.settings, constraint.diagonal(), plan.passes > 1);
  fem::LinearForces forces(matrix);
  std::unique_ptr<host::FrameMethod> method;
  if (plan.passes > 1) {
    host::Refinement refinement;
    refinement.passes = plan.passes;
    method =
        std::make_unique<host::RefinedSolve>(refinement, forces, matrix, board.words(), initial);
  } else {
    method = std::make_unique<host::BoardWords>(constraint, board, initial, fem::Effort::counted);
  }
  double operations = method->force_operations();
  for (const host::Step& step : method->steps()) operations += step.times * step.operations;
  return operations;
}

}  // namespace

FrameCost frame_cost(const sparse::BlockMatrix& matrix, const fixed::Plan& plan) {
  const accel::Architecture architecture;
  const link::Pci bus;
  const host::Host pc;
  const fixed::Settings& s = plan.settings;
  const accel::Pattern pattern = accel::pattern_of(matrix.row_begin);
  const accel::SolveCycles cycles =
      accel::solve_cycles(architecture, pattern, accel::longest_solve(s));
  FrameCost cost;
  const double clock_us = static_cast<double>(architecture.clock_period_ps()) * kUsPerPs;
  cost.board_us = plan.passes * static_cast<double>(cycles.total()) * clock_us;
  const std::int64_t transfer_ps = bus.write_ps(bytes_of(matrix.rows(), s.residual_bits())) +
                                   bus.read_ps(bytes_of(matrix.rows(), s.vector_bits));
  cost.bus_us = plan.passes * static_cast<double>(transfer_ps) * kUsPerPs;
  cost.host_us = static_cast<double>(pc.compute_ps(host_operations(matrix, plan))) * kUsPerPs;
  cost.device = smallest_device(accel::word_lengths(s), pattern);
  return cost;
}

}  // namespace hvp::tables
