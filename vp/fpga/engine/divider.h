#pragma once

#include <cstdint>
#include <systemc>

#include "models/fixed/reference_machine.h"
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
  bool hold = false;      // the divider works, and its quotient is ignored
};

struct Quotient {
  std::uint32_t number = 0;
  fixed::Coefficient value;
};

// The divider of α and β. It shifts and subtracts, with the same number of clocks for every
// division: `clocks` from the command's edge to the quotient's.
class Divider : public sc_core::sc_module {
 public:
  explicit Divider(const sc_core::sc_module_name& name) : sc_module(name) {}

  const Register<DivisionCommand>* command = nullptr;
  Register<Quotient> quotient;

  // Sets the words and rules of the next jobs.
  void configure(const fixed::Settings& settings, int clocks);
  void clocked();
  void reset() { busy_ = false; }
  fixed::Report& report() { return report_; }
  bool busy() const { return busy_; }

 private:
  fixed::Settings settings_;
  fixed::Report report_;
  fixed::ReferenceMachine machine_{settings_, report_};
  int clocks_ = 1;
  int left_ = 0;
  bool busy_ = false;
  std::uint32_t number_ = 0;
};

}  // namespace hvp::vp::engine
