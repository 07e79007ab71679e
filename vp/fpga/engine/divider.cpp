#include "vp/fpga/engine/divider.h"

#include <stdexcept>

namespace hvp::vp::engine {

void Divider::configure(const fixed::Settings& settings, int clocks) {
  settings_ = settings;
  clocks_ = clocks;
}

void Divider::clocked() {
  const DivisionCommand& next = command->read();
  if (next.number != command_.number) {
    command_ = next;
    begin();
  } else if (busy_ && phase_ == Phase::operands) {
    if (--operands_left_ == 0) divide();
  } else if (busy_ && phase_ == Phase::divide) {
    if (division_.step()) take_quotient();
  } else if (busy_ && phase_ == Phase::rescale) {
    rescale();
  }
  if (!busy_ || --left_ > 0) return;
  // Operands that come late leave a re-scaling as many clocks less: it is then made in fewer, with
  // a multiplier (vp/fpga/rtl/engine/scaler.sv).
  for (int i = 0; i < command_.late && phase_ == Phase::rescale; ++i) rescale();
  if (phase_ != Phase::wait) throw std::logic_error("a division outlasts its clocks");
  busy_ = false;
  quotient.write(result_);
}

void Divider::begin() {
  busy_ = true;
  left_ = clocks_ - 1;  // the command's register takes the first edge
  result_ = {command_.number, {}, 0};
  phase_ = Phase::wait;
  if (command_.hold) return;
  phase_ = Phase::operands;
  operands_left_ = command_.late;
  if (operands_left_ == 0) divide();
}

void Divider::divide() {
  phase_ = Phase::divide;
  command_ = command->read();
  division_.start(settings_, command_.numerator, command_.denominator, command_.fraction_bits);
}

void Divider::take_quotient() {
  result_.value = division_.quotient();
  if (division_.beyond()) {
    ++(settings_.overflow == fixed::Overflow::saturate ? report_.saturations : report_.wraps);
  }
  rescaling_.start(settings_, command_.rescaling, result_.value);
  phase_ = Phase::rescale;
}

void Divider::rescale() {
  if (!rescaling_.step()) return;
  result_.up = rescaling_.up();
  phase_ = Phase::wait;
}

}  // namespace hvp::vp::engine
