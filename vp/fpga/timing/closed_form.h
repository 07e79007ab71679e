#pragma once

#include <optional>

#include "models/accel/board_clocks.h"
#include "vp/fpga/timing/job_timing.h"

namespace hvp::vp {

// accel::BoardClocks: known when a job starts.
class ClosedForm : public JobTiming {
 public:
  explicit ClosedForm(const accel::Architecture& architecture) : architecture_(architecture) {}

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override;
  std::optional<std::int64_t> start_load(fixed::Method method) override;
  std::optional<std::int64_t> start_solve(const fixed::Settings& settings,
                                          const fixed::Report& report) override;
  std::int64_t update_node(const fixed::QuantisedMatrix& matrix, int node, fixed::Method method,
                           std::span<const std::int32_t> row) override;

 private:
  accel::Architecture architecture_;
  std::optional<accel::BoardClocks> clocks_;  // of the loaded matrix
};

}  // namespace hvp::vp
