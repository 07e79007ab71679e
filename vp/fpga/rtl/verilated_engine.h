#pragma once

#include <memory>

// Verilator's headers take SystemC's clock for theirs and expect its name here.
#include <systemc>
using sc_core::sc_time_stamp;

#include <verilated.h>

#include "vp/fpga/rtl/engine_model.h"

namespace hvp::vp::rtl {

// The class that Verilator has made of engine.sv in one size.
template <class Top>
class VerilatedEngine : public EngineModel {
 public:
  explicit VerilatedEngine(int seed) : context_(std::make_unique<VerilatedContext>()) {
    context_->randReset(2);
    context_->randSeed(seed);
    top_ = std::make_unique<Top>(context_.get());
    // The first evaluation finds no edge, whatever the clock is.
    top_->clock = 0;
    top_->eval();
  }
  ~VerilatedEngine() override { top_->final(); }

  void tick() override {
    top_->clock = 0;
    settle();
    top_->clock = 1;
    top_->eval();
    read_outputs();
  }

  void settle() override {
    top_->reset = ports.reset ? 1 : 0;
    top_->host_write = ports.host_write ? 1 : 0;
    top_->host_space = static_cast<CData>(ports.host_space);
    top_->host_address = ports.host_address;
    top_->host_word = ports.host_word;
    top_->go = ports.go ? 1 : 0;
    top_->copy = ports.copy ? 1 : 0;
    top_->invert = ports.invert ? 1 : 0;
    top_->edit = ports.edit ? 1 : 0;
    top_->forget_previous = ports.forget_previous ? 1 : 0;
    top_->eval();
    ports.host_read = static_cast<std::int32_t>(top_->host_read);
  }

 private:
  void read_outputs() {
    ports.host_read = static_cast<std::int32_t>(top_->host_read);
    ports.state = top_->state_number;
    ports.editing = top_->editing != 0;
    ports.finished = top_->finished != 0;
    ports.iteration_made = top_->iteration_made != 0;
    ports.breakdown = top_->breakdown != 0;
    ports.reached = top_->reached != 0;
    ports.scalar_overflow = top_->scalar_overflow != 0;
    ports.iterations_made = top_->iterations_made;
    ports.replacements = top_->replacements;
    ports.clamped = top_->clamped;
    ports.alpha = static_cast<std::int32_t>(top_->alpha);
    ports.alpha_exponent = static_cast<std::int32_t>(top_->alpha_exponent);
    ports.beta = static_cast<std::int32_t>(top_->beta);
    ports.beta_exponent = static_cast<std::int32_t>(top_->beta_exponent);
    ports.r_exponent = static_cast<std::int32_t>(top_->r_exponent);
    ports.z_exponent = static_cast<std::int32_t>(top_->z_exponent);
    ports.d_exponent = static_cast<std::int32_t>(top_->d_exponent);
    ports.z_r = static_cast<std::int64_t>(top_->z_r);
    ports.d_q = static_cast<std::int64_t>(top_->d_q);
  }

  std::unique_ptr<VerilatedContext> context_;
  std::unique_ptr<Top> top_;
};

}  // namespace hvp::vp::rtl
