#include "tables/hard_cases/cost.h"

#include <vector>

#include "app/devices/devices.h"
#include "models/accel/cycles.h"
#include "models/accel/memory.h"
#include "models/fixed/system.h"
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
  if (plan.passes > 1) {
    const fixed::System system = fixed::prepare(matrix, s);
    host::Refinement refinement;
    refinement.passes = plan.passes;
    const host::RefinedSolve refined(refinement, matrix, system,
                                     std::vector<double>(static_cast<std::size_t>(matrix.rows())));
    double operations = refined.finish_operations();
    for (int pass = 0; pass < plan.passes; ++pass) {
      operations += refined.residual_operations(pass > 0) + refined.accept_operations();
    }
    cost.host_us = static_cast<double>(pc.compute_ps(operations)) * kUsPerPs;
  } else {
    const double operations = 2 * host::conversion_operations(matrix.rows());
    cost.host_us = static_cast<double>(pc.compute_ps(operations)) * kUsPerPs;
  }
  cost.device = smallest_device(accel::word_lengths(s), pattern);
  return cost;
}

}  // namespace hvp::tables
