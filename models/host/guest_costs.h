#pragma once

#include "models/config/declaration.h"

namespace hvp::host {

// The scenario's effect [guest]: what the processor of `hvp linux` takes time for. Without it a
// kernel's instructions take none, and its interrupts reach it at their exact time. With it, an
// interrupt takes Host::interrupt_latency_s, or what [host.interrupt_latencies] draws.
struct GuestCosts {
  // A wait of the kernel's that is longer counts as a sleep of its programs (app/linux/guest.cpp).
  static constexpr double kLongestSystemCall = 9e-6;

  double system_call_s = 0.17e-6;  // before each call does anything

  void declare(config::Visitor& v);
};

}  // namespace hvp::host
