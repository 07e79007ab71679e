#pragma once

#include <cstdint>
#include <systemc>

#include "models/fixed/division.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "models/fixed/types.h"
#include "vp/fpga/engine/engine_clock.h"

namespace hvp::vp::engine {

struct DivisionCommand {
  std::uint32_t number = 0;  // every change starts a division
  fixed::Int128 numerator = 0;
  fixed::Int128 denominator = 1;
  int fraction_bits = 0;  // for fixed coefficients
  int late = 0;           // clocks for which the denominator may still change
  bool hold = false;      // the divider works, and its quotient is ignored
  // What the re-scaling behind the division starts from.
  fixed::RescalingSteps::Operands rescaling{};
};

struct Quotient {
  std::uint32_t number = 0;
  fixed::Coefficient value;
  int up = 0;  // the power of two of the re-scaling
};

// The divider of α and β and the re-scaling behind it, a step an edge (models/fixed/division.h).
// Every command takes the same number of clocks, from its edge to the quotient's, so that a solve's
// clocks do not depend on its words.
class Divider : public sc_core::sc_module {
 public:
  explicit Divider(const sc_core::sc_module_name& name) : sc_module(name) {}

  const Register<DivisionCommand>* command = nullptr;
  Register<Quotient> quotient;

  // Sets the words and rules of the next jobs. `clocks` are at least
  // fixed::shortest_division(settings).
  void configure(const fixed::Settings& settings, int clocks);
  void clocked();
  // A command that it has not taken yet is not wanted any more.
  void reset() {
    busy_ = false;
    command_.number = command->next().number;
  }
  fixed::Report& report() { return report_; }
  bool busy() const { return busy_; }

 private:
  enum class Phase { operands, divide, rescale, wait };

  void begin();
  void divide();
  void take_quotient();
  void rescale();

  fixed::Settings settings_;
  fixed::Report report_;
  fixed::DivisionSteps division_;
  fixed::RescalingSteps rescaling_;
  Phase phase_ = Phase::wait;
  int clocks_ = 1;
  int left_ = 0;
  int operands_left_ = 0;  // clocks
  bool busy_ = false;
  DivisionCommand command_;
  Quotient result_;
};

}  // namespace hvp::vp::engine
