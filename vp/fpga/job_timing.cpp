#include "vp/fpga/job_timing.h"

#include <cstddef>
#include <optional>

#include "models/accel/board.h"
#include "vp/fpga/engine/phase_engine.h"
#include "vp/fpga/every_clock.h"
#include "vp/fpga/rtl_timing.h"

namespace hvp::vp {

namespace {

// The closed form, accel::BoardClocks, whose clocks are known when a job starts.
class ClosedForm : public JobTiming {
 public:
  explicit ClosedForm(const accel::Architecture& architecture) : architecture_(architecture) {}

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override;
  std::optional<std::int64_t> start_load(const fixed::Settings& settings) override;
  std::optional<std::int64_t> start_solve(const fixed::Settings& settings,
                                          const fixed::Report& report) override;
  std::int64_t update_node(const fixed::QuantisedMatrix& matrix, int node,
                           const fixed::Settings& settings,
                           std::span<const std::int32_t> row) override;

 private:
  accel::Architecture architecture_;
  std::optional<accel::BoardClocks> clocks_;  // of the loaded matrix
};

void ClosedForm::load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& /*settings*/) {
  clocks_.emplace(architecture_, accel::pattern_of(matrix.row_begin, matrix.column));
}

std::optional<std::int64_t> ClosedForm::start_load(const fixed::Settings& settings) {
  return clocks_->load(settings);
}

std::optional<std::int64_t> ClosedForm::start_solve(const fixed::Settings& settings,
                                                    const fixed::Report& report) {
  return clocks_->solve(accel::solve_made(settings, report)).total();
}

std::int64_t ClosedForm::update_node(const fixed::QuantisedMatrix& matrix, int node,
                                     const fixed::Settings& settings,
                                     std::span<const std::int32_t> /*row*/) {
  const auto row = static_cast<std::size_t>(node);
  const auto begin = static_cast<std::size_t>(matrix.row_begin[row]);
  const auto end = static_cast<std::size_t>(matrix.row_begin[row + 1]);
  return clocks_->node_update(node, std::span(matrix.column).subspan(begin, end - begin), settings);
}

// One event for each phase of a solve, by engine::PhaseEngine; all other jobs in closed form.
class PhaseByPhase : public ClosedForm {
 public:
  explicit PhaseByPhase(const accel::Architecture& architecture)
      : ClosedForm(architecture), engine_("phases", architecture) {}

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) override {
    engine_.load(matrix, settings);
    ClosedForm::load(matrix, settings);
  }
  std::optional<std::int64_t> start_solve(const fixed::Settings& settings,
                                          const fixed::Report& report) override {
    engine_.start_solve(settings, report);
    return std::nullopt;
  }
  void abort() override { engine_.abort(); }
  const sc_core::sc_event* ended() const override { return &engine_.done(); }
  std::optional<SolveClocks> solve_clocks() const override {
    return SolveClocks{engine_.clocks(), engine_.state_clocks()};
  }
  void write_x(std::span<const std::int32_t> /*words*/) override { engine_.written_x(); }

 private:
  engine::PhaseEngine engine_;
};

}  // namespace

std::unique_ptr<JobTiming> make_job_timing(Timing level, const accel::Architecture& architecture) {
  switch (level) {
    case Timing::untimed:
    case Timing::loosely_timed:
      break;
    case Timing::approximately_timed:
      return std::make_unique<PhaseByPhase>(architecture);
    case Timing::cycle_accurate:
      return std::make_unique<EveryClock>(architecture);
    case Timing::rtl:
      return make_rtl_timing(architecture);
  }
  return std::make_unique<ClosedForm>(architecture);
}

}  // namespace hvp::vp
