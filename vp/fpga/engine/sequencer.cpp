#include "vp/fpga/engine/sequencer.h"

#include "models/fixed/reference_preconditioner.h"
#include "models/fixed/word.h"

namespace hvp::vp::engine {

namespace {

// Bits of magnitude that re-scaling leaves the 32-bit r of PCG (docs/fixed-point.md).
constexpr int kWideResidualBits = 25;

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

void Sequencer::abort() { command(State::idle, {.pass = Pass::none}); }

void Sequencer::clocked() {
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
  if (state_ == State::alpha) {
    s.alpha = taken.value;
    s.alpha.exponent += s.d_q.exponent - s.z_r.exponent;
    form_update(taken.up);
    return;
  }
  s.beta = {};
  if (!no_beta_) {
    s.beta = taken.value;
    s.beta.exponent += z_r_before_.exponent - s.z_r.exponent;
  }
  form_direction(taken.up);
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
  if (hold_) return;
  s.largest_r = status.largest_r;
  s.largest_z = status.largest_z;
  s.z_exponent = s.r_exponent;
  if (settings_.preconditioned()) {
    s.z_exponent += fixed::ReferencePreconditioner::scale_bits(settings_) - inverse_shift_;
  }
  s.z_r = {machine_.write_scalar(status.dot), s.z_exponent + s.r_exponent};
  residual_squares_ = static_cast<fixed::UInt128>(status.squares);
}

void Sequencer::form_first_direction() {
  Scalars& s = scalars_;
  // Without dynamic scaling the direction of PCG is in units of x (thesis §4.3).
  s.d_exponent = settings_.preconditioned() ? 0 : s.z_exponent;
  if (settings_.dynamic_scaling) {
    s.d_exponent = s.z_exponent + direction_target_ - fixed::bit_length(s.largest_z);
  }
  command(State::first_direction,
          {.pass = Pass::first_direction, .z_shift = s.d_exponent - s.z_exponent});
}

// ‖r‖ <= stop_residual · ‖b‖.
bool Sequencer::reached() const {
  if (settings_.stop_residual == 0) return false;
  return stop_test_.reached(residual_squares_, scalars_.r_exponent);
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
  divide(State::alpha,
         {.numerator = divided(s.z_r.word),
          .denominator = s.d_q.word,
          .fraction_bits = settings_.alpha_fraction_bits,
          // r is bounded by |r| + α·|q|.
          .rescaling = {.a = s.largest_r,
                        .a_exponent = 0,
                        .largest = s.largest_q,
                        .b_exponent = s.d_q.exponent - s.z_r.exponent - s.q_exponent + s.r_exponent,
                        .word_bits = settings_.residual_bits(),
                        .target_bits = residual_target_,
                        .available_bits = residual_available_}});
}

fixed::Int128 Sequencer::flipped_scalar(int bit) const {
  const int unused = 128 - settings_.scalar_bits;
  const auto changed = static_cast<fixed::UInt128>(scalars_.z_r.word) ^ (fixed::UInt128{1} << bit);
  return static_cast<fixed::Int128>(changed << unused) >> unused;
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
  const int exponent = s.alpha.exponent - s.q_exponent + s.r_exponent;
  s.shown_alpha = {s.alpha.mantissa, exponent};
  if (replaced_) up = 0;
  s.r_exponent += up;
  command(State::update, {.pass = Pass::update,
                          .exchange = replaced_,
                          .alpha = s.alpha.mantissa,
                          .x_shift = s.alpha.exponent - s.d_exponent,
                          .r_shift = up,
                          .change_shift = exponent + up});
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
                       // d is bounded by |z| + β·|d|.
                       .rescaling = {.a = s.largest_z,
                                     .a_exponent = s.d_exponent - s.z_exponent,
                                     .largest = s.largest_d,
                                     .b_exponent = z_r_before_.exponent - s.z_r.exponent,
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
