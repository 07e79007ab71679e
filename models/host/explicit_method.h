#pragma once

#include <span>
#include <vector>

#include "models/fem/explicit_steps.h"
#include "models/host/frame_method.h"

namespace hvp::host {

// The method in which no system is solved: the host moves the body by explicit time steps, with a
// watch on how long they may be.
class ExplicitMethod final : public FrameMethod {
 public:
  // Keeps a reference.
  explicit ExplicitMethod(fem::ExplicitSteps& steps) : steps_(steps) {}

  void begin(std::span<const double> /*f*/, const fem::Hold& /*hold*/) override { flags_ = {}; }
  // Steps have no matrix whose compliance contact by loads could use. Throws std::logic_error.
  void go_on(std::span<const double> f, double way) override;
  bool next(std::span<std::int32_t> b) override;
  void accept(std::span<const std::int32_t> /*x*/, stability::Flags /*flags*/) override {}

  std::span<const double> displacement() const override { return steps_.displacement(); }
  stability::Flags flags() const override { return flags_; }
  double next_operations() const override { return 0; }
  SolveWork solve_work() const override { return {.sparse = operations_}; }
  std::vector<Step> steps() const override;

 private:
  fem::ExplicitSteps& steps_;
  stability::Flags flags_;
  double operations_ = 0;
};

}  // namespace hvp::host
