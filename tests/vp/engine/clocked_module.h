#pragma once

#include <memory>

// Verilator's headers take SystemC's clock for theirs and expect its name here.
#include <systemc>
using sc_core::sc_time_stamp;

#include <verilated.h>

namespace hvp::vp::rtl::test {

// A module of the RTL engine by itself, which works from `start` to `done`.
template <class Top>
class ClockedModule {
 public:
  ClockedModule() : context_(std::make_unique<VerilatedContext>()), top_(context_.get()) {
    top_.clock = 0;
    top_.eval();
    top_.reset = 1;
    tick();
    top_.reset = 0;
  }
  ~ClockedModule() { top_.final(); }
  ClockedModule(const ClockedModule&) = delete;
  ClockedModule& operator=(const ClockedModule&) = delete;

  // Its ports.
  Top& operator*() { return top_; }
  Top* operator->() { return &top_; }

  // The clocks from its start until it is done; kMost where it never is.
  int run() {
    top_.start = 1;
    tick();
    top_.start = 0;
    int clocks = 0;
    for (; top_.done == 0 && clocks < kMost; ++clocks) tick();
    return clocks;
  }

  static constexpr int kMost = 200;

  void tick() {
    top_.clock = 0;
    top_.eval();
    top_.clock = 1;
    top_.eval();
  }

 private:
  std::unique_ptr<VerilatedContext> context_;
  Top top_;
};

}  // namespace hvp::vp::rtl::test
