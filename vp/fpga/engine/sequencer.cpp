#include "vp/fpga/engine/sequencer.h"

#include <algorithm>

#include "models/fixed/reference_preconditioner.h"
#include "models/fixed/word.h"

namespace hvp::vp::engine {

namespace {

// Bits of magnitude that re-scaling leaves the 32-bit r of PCG (docs/fixed-point.md).
constexpr int kWideResidualBits = 25;
// The largest power of two of a re-scaling, of 8 bits.
constexpr int kMostRescaling = 255;

}  // namespace

const char* name(State state) {
  switch (state) {
    case State::idle:
      return "idle";
    case State::copy:
      return "copy";
    case State::guess:
      return "guess";
    case State::start_product:
      return "start_product";
    case State::start_residual:
      return "start_residual";
    case State::first_direction:
      return "first_direction";
    case State::product:
      return "product";
    case State::alpha:
      return "alpha";
    case State::update:
      return "update";
    case State::anew_product:
      return "anew_product";
    case State::anew_residual:
      return "anew_residual";
    case State::beta:
      return "beta";
    case State::direction:
      return "direction";
  }
  return "";
}

void Sequencer::start(const fixed::Settings& settings, int inverse_shift, bool has_previous) {
  settings_ = settings;
  inverse_shift_ = inverse_shift;
  direction_target_ = settings.vector_bits - 1 - settings.headroom_bits;
  residual_target_ = settings.preconditioned() ? kWideResidualBits : direction_target_;
  residual_available_ = settings.preconditioned() ? kWideResidualBits : settings.vector_bits - 1;
  report_ = {};
  scalars_ = {};
  enter(State::idle);
  state_clocks_ = {};
  loops_ = 0;
  late_ = settings.preconditioned() ? late_sums_ : 0;
  late_left_ = 0;
  operands_left_ = 0;
  hold_ = false;
  replaced_ = false;
  zero_ = settings.start == fixed::Start::zero;
  if (settings.start == fixed::Start::extrapolated) {
    command(State::guess, {.pass = Pass::guess, .alone = !has_previous});
  } else {
    multiply(State::start_product, true);
  }
}

void Sequencer::copy() { command(State::copy, {.pass = Pass::copy}); }

void Sequencer::abort() {
  late_left_ = 0;
  operands_left_ = 0;
  command(State::idle, {.pass = Pass::none});
}

void Sequencer::clocked() {
  if (late_left_ > 0) --late_left_;
  if (operands_left_ > 0) --operands_left_;
  if (state_ == State::idle) return;
  if (state_ == State::alpha || state_ == State::beta) {
    if (quotient->read().number == division_number_) take_quotient(quotient->read());
  } else if (vector_status->read().number == vector_number_) {
    pass_is_over(vector_status->read());
  }
}

void Sequencer::pass_is_over(const VectorStatus& status) {
  switch (state_) {
    case State::copy:
      enter(State::idle);
      if (copied) copied();
      break;
    case State::guess:
      multiply(State::start_product, true);
      break;
    case State::start_product:
      stop_test_ =
          fixed::StopTest(settings_.stop_residual, static_cast<fixed::UInt128>(status.squares),
                          settings_.rhs_shift());
      form_residual(State::start_residual, status);
      break;
    case State::start_residual:
      take_residual(status);
      form_first_direction();
      break;
    case State::product:
      take_product(status);
      break;
    case State::update:
      if (replaced_) {
        multiply(State::anew_product, true);
        break;
      }
      take_residual(status);
      form_beta();
      break;
    case State::anew_product:
      form_residual(State::anew_residual, status);
      break;
    case State::anew_residual:
      take_residual(status);
      form_beta();
      break;
    case State::direction:
      loops_ = (loops_ + 1) & ((1 << kLoopBits) - 1);
      if (!hold_ && iteration_made) iteration_made();
      [[fallthrough]];
    case State::first_direction:
      if (!hold_) scalars_.largest_d = status.largest_d;
      begin_iteration();
      break;
    case State::idle:
    case State::alpha:
    case State::beta:
      break;
  }
}

void Sequencer::take_quotient(const Quotient& taken) {
  Scalars& s = scalars_;
  // Only an exponent that has flipped asks for more than the register has.
  const int most = kMostRescaling - kMostRescaling % settings_.scaling_step;
  const int up = std::clamp(taken.up, -most, most);
  if (state_ == State::alpha) {
    s.alpha = taken.value;
    s.alpha.exponent += quotient_unit_;
    s.shown_alpha = {s.alpha.mantissa, taken.value.exponent + change_unit_};
    form_update(up);
    return;
  }
  s.beta = {};
  if (!no_beta_) {
    s.beta = taken.value;
    s.beta.exponent += quotient_unit_;
  }
  form_direction(up);
}

// For whoever reads the clocks; no decision hangs on them.
void Sequencer::enter(State state) {
  const sc_core::sc_time& now = sc_core::sc_time_stamp();
  state_clocks_[static_cast<std::size_t>(state_)] +=
      static_cast<std::int64_t>((now - entered_).value() / clock_.period().value());
  entered_ = now;
  state_ = state;
}

void Sequencer::command(State state, VectorCommand next) {
  enter(state);
  next.number = ++vector_number_;
  vector_command.write(next);
}

void Sequencer::multiply(State state, bool compare) {
  product_start.write(++products_);
  command(state, {.pass = Pass::product,
                  .hold = hold_,
                  .compare = compare,
                  .zero = zero_ && state == State::start_product});
}

void Sequencer::divide(State state, DivisionCommand next) {
  enter(state);
  operands_left_ = next.late + 1;
  if (!next.hold) take_exponents(next.rescaling);
  next.number = ++division_number_;
  division_command.write(next);
}

void Sequencer::end() {
  enter(State::idle);
  if (finished) finished();
}

// r = b − A·x. Its exponent follows from the size of the difference.
void Sequencer::form_residual(State state, const VectorStatus& product) {
  scalars_.r_exponent = -settings_.rhs_shift();
  if (settings_.dynamic_scaling && product.widest != 0) {
    scalars_.r_exponent = residual_target_ - fixed::bit_length(product.widest);
  }
  command(state, {.pass = Pass::residual,
                  .first = state == State::start_residual,
                  .zero = zero_ && state == State::start_residual,
                  .exchange = state == State::anew_residual,
                  .r_shift = scalars_.r_exponent});
}

void Sequencer::take_residual(const VectorStatus& status) {
  Scalars& s = scalars_;
  z_r_before_ = s.z_r;
  late_left_ = late_;
  stopping_exponent_ = s.r_exponent;
  if (hold_) return;
  s.largest_r = status.largest_r;
  s.largest_z = status.largest_z;
  s.z_exponent = z_exponent();
  s.z_r = {machine_.write_scalar(status.dot), s.z_exponent + s.r_exponent};
  residual_squares_ = static_cast<fixed::UInt128>(status.squares);
}

int Sequencer::z_exponent() const {
  if (!settings_.preconditioned()) return scalars_.r_exponent;
  return scalars_.r_exponent + fixed::ReferencePreconditioner::scale_bits(settings_) -
         inverse_shift_;
}

// Without dynamic scaling the direction of PCG is in units of x (thesis §4.3).
int Sequencer::first_up() const {
  if (settings_.dynamic_scaling) return direction_target_ - fixed::bit_length(scalars_.largest_z);
  return settings_.preconditioned() ? -scalars_.z_exponent : 0;
}

void Sequencer::form_first_direction() {
  Scalars& s = scalars_;
  s.d_exponent = s.z_exponent + first_up();
  command(State::first_direction,
          {.pass = Pass::first_direction, .z_shift = s.d_exponent - s.z_exponent});
}

// ‖r‖ <= stop_residual · ‖b‖.
bool Sequencer::reached() const {
  if (settings_.stop_residual == 0) return false;
  return stop_test_.reached(residual_squares_, stopping_exponent_);
}

void Sequencer::begin_iteration() {
  if (loops_ == settings_.iterations) {
    end();
    return;
  }
  if (!hold_ && reached()) {
    report_.reached = true;
    end();
    return;
  }
  if (scalars_.z_r.word <= 0 || scalars_.largest_d == 0) hold_ = true;
  scalars_.q_exponent = scalars_.d_exponent - settings_.product_shift();
  multiply(State::product, false);
}

void Sequencer::take_product(const VectorStatus& status) {
  Scalars& s = scalars_;
  if (hold_) {
    divide(State::alpha, {.hold = true});
    return;
  }
  s.largest_q = status.largest_q;
  s.d_q = {machine_.write_scalar(status.dot), s.d_exponent + s.q_exponent};
  if (s.d_q.word <= 0) {
    report_.flags.raise(stability::Flag::negative_curvature);
    ++report_.breakdowns;
    end();
    return;
  }
  divide(State::alpha, {.numerator = divided(s.z_r.word),
                        .denominator = s.d_q.word,
                        .fraction_bits = settings_.alpha_fraction_bits,
                        // r is bounded by |r| + α·|q|.
                        .rescaling = {.a = s.largest_r,
                                      .largest = s.largest_q,
                                      .word_bits = settings_.residual_bits(),
                                      .target_bits = residual_target_,
                                      .available_bits = residual_available_}});
}

// The divider waits as long as the sum, and takes what the register has then.
void Sequencer::flip_r_r(int bit) {
  const int unused = 128 - settings_.scalar_bits;
  fixed::Int128& word = late_left_ > 0 ? z_r_before_.word : scalars_.z_r.word;
  const auto changed = static_cast<fixed::UInt128>(word) ^ (fixed::UInt128{1} << bit);
  word = static_cast<fixed::Int128>(changed << unused) >> unused;
  DivisionCommand division = division_command.next();
  if (late_left_ == 0 || state_ != State::beta || division.hold) return;
  division.denominator = divided(word);
  division_command.reset(division);
}

// The exponents that a division and its re-scaling start from.
void Sequencer::take_exponents(fixed::RescalingSteps::Operands& operands) {
  const Scalars& s = scalars_;
  if (state_ == State::alpha) {
    quotient_unit_ = 2 * s.d_exponent - settings_.product_shift() - s.z_r.exponent;
    change_unit_ = s.d_exponent - s.z_r.exponent + s.r_exponent;
    operands.b_exponent = change_unit_;
  } else {
    quotient_unit_ = z_r_before_.exponent - s.z_r.exponent;
    operands.a_exponent = s.d_exponent - s.z_exponent;
    operands.b_exponent = quotient_unit_;
  }
}

// What is formed of an exponent follows, until it is in a register of its own.
void Sequencer::flip_exponent(FlipPlace place, int bit) {
  Scalars& s = scalars_;
  const bool of_r = place == FlipPlace::r_exponent;
  (of_r ? s.r_exponent : s.d_exponent) ^= 1 << bit;
  s.z_exponent = z_exponent();
  if (late_left_ > 0 && !hold_) {
    s.z_r.exponent = s.z_exponent + s.r_exponent;
    if (state_ == State::first_direction) {
      s.d_exponent = s.z_exponent + first_up();
      VectorCommand next = vector_command.read();
      next.z_shift = first_up();
      vector_command.reset(next);
    }
  }
  DivisionCommand division = division_command.next();
  if (operands_left_ == 0 || division.hold) return;
  take_exponents(division.rescaling);
  division_command.reset(division);
}

// What the divider takes of a scalar: all bits but that of the sign, which only a flip can set once
// the scalar has been found positive.
fixed::Int128 Sequencer::divided(fixed::Int128 scalar) const {
  const auto mask = (fixed::UInt128{1} << (settings_.scalar_bits - 1)) - 1;
  return static_cast<fixed::Int128>(static_cast<fixed::UInt128>(scalar) & mask);
}

// The register that the lanes multiply by: of a command that the vector unit has not seen yet.
void Sequencer::flip_coefficient(int bit) {
  VectorCommand next = vector_command.read();
  (next.pass == Pass::direction ? next.beta : next.alpha) ^= 1 << bit;
  vector_command.reset(next);
}

bool Sequencer::replaces() {
  if (hold_ || settings_.replace_residual_every == 0) return false;
  if (report_.iterations % settings_.replace_residual_every != 0) return false;
  ++report_.replacements;
  return true;
}

// x += α·d, r −= α·q with r re-scaled.
void Sequencer::form_update(int up) {
  Scalars& s = scalars_;
  if (hold_) {
    replaced_ = false;
    command(State::update, {.pass = Pass::update, .hold = true});
    return;
  }
  ++report_.iterations;
  replaced_ = replaces();
  if (replaced_) up = 0;
  s.r_exponent += up;
  command(State::update, {.pass = Pass::update,
                          .exchange = replaced_,
                          .alpha = s.alpha.mantissa,
                          .x_shift = s.alpha.exponent - s.d_exponent,
                          .r_shift = up,
                          .change_shift = s.shown_alpha.exponent + up});
}

void Sequencer::form_beta() {
  const Scalars& s = scalars_;
  no_beta_ = s.z_r.word <= 0;
  if (hold_ || no_beta_) {
    divide(State::beta, {.hold = true});
    return;
  }
  divide(State::beta, {.numerator = s.z_r.word,
                       .denominator = divided(z_r_before_.word),
                       .fraction_bits = settings_.beta_fraction_bits,
                       .late = late_,
                       // d is bounded by |z| + β·|d|.
                       .rescaling = {.a = s.largest_z,
                                     .largest = s.largest_d,
                                     .word_bits = settings_.vector_bits,
                                     .target_bits = direction_target_,
                                     .available_bits = settings_.vector_bits - 1}});
}

// d = z + β·d, re-scaled.
void Sequencer::form_direction(int up) {
  Scalars& s = scalars_;
  if (hold_) {
    command(State::direction, {.pass = Pass::direction, .hold = true});
    return;
  }
  s.d_exponent += up;
  command(State::direction, {.pass = Pass::direction,
                             .beta = s.beta.mantissa,
                             .z_shift = s.d_exponent - s.z_exponent,
                             .d_shift = s.beta.exponent + up});
}

}  // namespace hvp::vp::engine
