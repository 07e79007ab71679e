#pragma once

#include <bit>
#include <memory>
#include <stdexcept>
#include <string>

// Verilator's headers take SystemC's clock for theirs and expect its name here.
#include <systemc>
using sc_core::sc_time_stamp;

#include <verilated.h>
#include <verilated_sym_props.h>

#include "vp/fpga/rtl/engine_model.h"
#include "vp/fpga/rtl/fst_file.h"

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
  ~VerilatedEngine() override {
    // The class takes its names out of the thread's context, which may be that of another engine.
    Verilated::threadContextp(context_.get());
    top_->final();
    top_.reset();
  }

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

  Cells cells(const std::string& instance, const char* variable) override {
    static_assert(std::endian::native == std::endian::little,
                  "a word's bits begin in its first byte");
    const std::string scope = std::string(top_->name()) + ".engine." + instance;
    const VerilatedScope* const found = context_->scopeFind(scope.c_str());
    const VerilatedVar* const memory = found == nullptr ? nullptr : found->varFind(variable);
    if (memory == nullptr || memory->udims() > 1) {
      throw std::logic_error("engine.sv shows no memory " + scope + "." + variable);
    }
    return {static_cast<std::byte*>(memory->datap()),
            memory->udims() == 0 ? 1 : memory->unpacked().elements(),
            memory->dims() == memory->udims() ? 1 : memory->packed().elements(),
            static_cast<int>(memory->entSize())};
  }

  void open_waveform(const std::string& path, const ShownSignals& shown) override {
    if constexpr (kTraced) {
      context_->traceEverOn(true);
      waveform_ = std::make_unique<FstFile>(path, *top_, shown);
    } else {
      throw std::logic_error("engine.sv was translated without tracing");
    }
  }
  void dump(std::int64_t time_ps) override {
    if constexpr (kTraced) waveform_->dump(time_ps);
  }
  void close_waveform() override {
    if constexpr (kTraced) waveform_.reset();
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
    ports.turn_waits = top_->turn_waits;
    ports.room_waits = top_->room_waits;
  }

  static constexpr bool kTraced = requires(Top & top, VerilatedFstC* file) { top.trace(file, 1); };

  std::unique_ptr<VerilatedContext> context_;
  std::unique_ptr<Top> top_;
  std::unique_ptr<FstFile> waveform_;
};

}  // namespace hvp::vp::rtl
