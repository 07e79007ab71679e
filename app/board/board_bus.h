#pragma once

#include <cstdint>

#include "driver/hvp_driver.h"
#include "vp/function/board_function.h"
#include "vp/host/transfer.h"

namespace hvp::app {

// What the driver reaches the board of a BoardFunction through, for a program that is no process of
// SystemC: its call-backs let simulated time go on. They throw nothing, so that no C frame is ever
// unwound.
class BoardBus : public vp::InterruptListener {
 public:
  // Keeps a reference and listens to the function.
  BoardBus(vp::BoardFunction& function, const vp::Transfer& transfer, bool reports_errors);
  BoardBus(const BoardBus&) = delete;
  BoardBus& operator=(const BoardBus&) = delete;

  // Valid as long as this object.
  const hvp_bus& bus() const { return bus_; }
  // Memory space and mastering on, and messages where the function has them: what an operating
  // system does before a driver is asked.
  void enumerate();
  // Whether INTA# is up, or a message has come since the last call.
  bool take_interrupt();

  // InterruptListener
  void message(const vp::ConfigSpace::Message& /*message*/) override { message_ = true; }
  void line(bool /*up*/) override {}

 private:
  int wait_interrupt(std::uint64_t timeout_ns);
  std::uint32_t take_errors();
  void let_pass(vp::Picoseconds time);

  vp::BoardFunction& function_;
  vp::Picoseconds poll_interval_;
  hvp_bus bus_{};
  bool message_ = false;
};

}  // namespace hvp::app
