#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <systemc>

#include "models/fixed/reference_machine.h"
#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "models/fixed/stop_test.h"
#include "vp/fpga/engine/divider.h"
#include "vp/fpga/engine/engine_clock.h"
#include "vp/fpga/engine/flip.h"
#include "vp/fpga/engine/vector_unit.h"

namespace hvp::vp::engine {

// The states of a solve. Their order follows from the data dependences of thesis Fig. 4.4: α needs
// dᵀA·d, which ends group a; group b needs α; β needs the residual's size, which ends group b;
// group c needs β.
enum class State {
  idle,
  copy,             // after a job: x into the copies of d, for the next one's first product
  guess,            // extrapolated start: x and the copies of d
  start_product,    // A·x
  start_residual,   // r = b − A·x
  first_direction,  // d = z
  product,          // group a
  alpha,
  update,        // group b
  anew_product,  // A·x amid the iterations: x and d have changed places
  anew_residual,
  beta,
  direction,  // group c
};
const char* name(State state);
inline constexpr std::size_t kStates = static_cast<std::size_t>(State::direction) + 1;

// The clocks that a solve has spent in each state, counted from its first pass.
using StateClocks = std::array<std::int64_t, kStates>;

// The contents of the control registers: the exponents and sizes of the vectors, and both scalars.
struct Scalars {
  int r_exponent = 0, z_exponent = 0, d_exponent = 0, q_exponent = 0;
  std::uint64_t largest_r = 0, largest_z = 0, largest_d = 0, largest_q = 0;
  fixed::ScaledScalar z_r, d_q;
  fixed::Coefficient alpha, beta;
  fixed::Coefficient shown_alpha;  // as it applies to q, for words of r as they were
};

// The control unit: starts the passes of a solve in order and keeps the exponents (dynamic scaling,
// thesis §4.2). It acts when a unit reports its end, and never counts clocks.
class Sequencer : public sc_core::sc_module {
 public:
  Sequencer(const sc_core::sc_module_name& name, const EngineClock& clock)
      : sc_module(name), clock_(clock) {}

  Register<std::uint32_t> product_start;  // to the SpMxV blocks
  Register<VectorCommand> vector_command;
  Register<DivisionCommand> division_command;
  const Register<VectorStatus>* vector_status = nullptr;
  const Register<Quotient>* quotient = nullptr;

  // Called when all words of an iteration are written, when the solve is over, and when a copy of x
  // is.
  std::function<void()> iteration_made;
  std::function<void()> finished;
  std::function<void()> copied;  // the copies of d contain x

  void clocked();
  // Starts a solve, whose first pass begins at once; x has to be in the copies of d.
  // `inverse_shift` is that of P⁻¹·r. `has_previous`: an extrapolated start has a solution before
  // x.
  void start(const fixed::Settings& settings, int inverse_shift, bool has_previous);
  // Starts to copy x into the copies of d, anew if a copy is under way.
  void copy();
  // Aborts a solve or a copy.
  void abort();

  // From now on a preconditioner's zᵀr is in its register so many clocks behind its pass.
  void sum_late(int clocks) { late_sums_ = clocks; }
  // A bit of a register, of so many, has flipped.
  void flip_r_r(int bit);
  void flip_exponent(FlipPlace place, int bit);
  void flip_loops(int bit) { loops_ ^= 1 << bit; }
  void flip_coefficient(int bit);

  State state() const { return state_; }
  const Scalars& scalars() const { return scalars_; }
  // The iterations, replacements, breakdowns and flags of the solve.
  const fixed::Report& report() const { return report_; }
  const StateClocks& state_clocks() const { return state_clocks_; }

 private:
  void pass_is_over(const VectorStatus& status);
  void take_quotient(const Quotient& taken);

  void enter(State state);
  void command(State state, VectorCommand next);
  void multiply(State state, bool compare);
  void divide(State state, DivisionCommand next);
  void end();

  void form_residual(State state, const VectorStatus& product);
  void take_residual(const VectorStatus& status);
  int z_exponent() const;
  int first_up() const;
  void form_first_direction();
  void begin_iteration();
  void take_product(const VectorStatus& status);
  void form_update(int up);
  void take_exponents(fixed::RescalingSteps::Operands& operands);
  void form_beta();
  void form_direction(int up);
  bool reached() const;
  bool replaces();
  fixed::Int128 divided(fixed::Int128 scalar) const;

  const EngineClock& clock_;
  fixed::Settings settings_;
  fixed::Report report_;
  fixed::ReferenceMachine machine_{settings_, report_};
  int inverse_shift_ = 0;
  int direction_target_ = 0;
  int residual_target_ = 0;
  int residual_available_ = 0;

  State state_ = State::idle;
  StateClocks state_clocks_{};
  int late_sums_ = 0;
  int late_ = 0;           // those of this solve
  int operands_left_ = 0;  // clocks until a division has its operands
  // The exponents of a quotient, and of α·q in units of r, less that of the mantissa.
  int quotient_unit_ = 0;
  int change_unit_ = 0;
  int stopping_exponent_ = 0;  // of r, as the stop test has it
  int late_left_ = 0;          // clocks for which the register still has the zᵀr before
  sc_core::sc_time entered_;
  Scalars scalars_;
  std::uint32_t vector_number_ = 0;
  std::uint32_t division_number_ = 0;
  std::uint32_t products_ = 0;
  int loops_ = 0;          // of kLoopBits
  bool zero_ = false;      // the solve starts from zero, whatever x is
  bool hold_ = false;      // the solve is over, and its passes go on
  bool no_beta_ = false;   // there is no residual, so that no direction of old counts
  bool replaced_ = false;  // this iteration's residual is formed anew
  fixed::StopTest stop_test_;
  fixed::UInt128 residual_squares_ = 0;  // rᵀr in words of r
  fixed::ScaledScalar z_r_before_;
};

}  // namespace hvp::vp::engine
