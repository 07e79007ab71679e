#pragma once

#include <cstdint>

#include "driver/hvp_driver.h"
#include "vp/function/outside_host.h"
#include "vp/host/transfer.h"

namespace hvp::app {

// The bus by which the driver reaches the board of a BoardFunction from a program that is not a
// SystemC process. Its call-backs advance simulated time. They throw nothing, so that no C frame is
// ever unwound.
class BoardBus : public vp::InterruptListener {
 public:
  // Keeps a reference and listens to the function.
  BoardBus(vp::BoardFunction& function, const vp::Transfer& transfer);
  BoardBus(const BoardBus&) = delete;
  BoardBus& operator=(const BoardBus&) = delete;

  // Valid as long as this BoardBus exists.
  const hvp_bus& bus() const { return bus_; }
  // Enables memory space and bus mastering, and messages if the function has them, as an operating
  // system does before the driver starts.
  void enumerate();
  // True if INTA# is up, or a message has arrived since the last call.
  bool take_interrupt();

  // InterruptListener
  void message(const vp::ConfigSpace::Message& /*message*/) override { message_ = true; }
  void line(bool /*up*/) override {}

 private:
  int wait_interrupt(std::uint64_t timeout_ns);
  void enable_table();
  std::uint32_t take_errors();
  void let_pass(vp::Picoseconds time);

  vp::BoardFunction& function_;
  vp::Picoseconds poll_interval_;
  hvp_bus bus_{};
  bool message_ = false;
};

}  // namespace hvp::app
