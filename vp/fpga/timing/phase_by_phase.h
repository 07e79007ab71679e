#pragma once

#include "vp/fpga/engine/phase_engine.h"
#include "vp/fpga/timing/closed_form.h"

namespace hvp::vp {

// An event a phase of a solve, by engine::PhaseEngine; all else in closed form.
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

}  // namespace hvp::vp
