#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/plant/wall_stability.h"
#include "vp/frame/frame.h"

// The closed loop: its stiffness budget, and texts for the terminal.

namespace hvp::results {

struct Outcome;

// The cost of latency in stiffness. With a force that is late by L, there is a stiffest wall with
// which the loop of device and hand is stable (models/plant/wall_stability.h); every part of L
// makes it softer by an amount.
struct StiffnessBudget {
  struct Share {
    std::string_view part;
    std::string_view phase;
    double time_s = 0;  // mean, after the latch
    double cost_N_m = 0;
  };
  // L: from the latch to the force at the motor, the mean of the frames in contact, or of all
  // frames where none was in contact.
  double delay_s = 0;
  double period_s = 0;     // T
  double stable_N_m = 0;   // by the exact eigenvalues
  double passive_N_m = 0;  // b/(T/2 + L)
  double without_delay_N_m = 0;
  std::vector<Share> shares;  // largest cost first

  void report(config::Figures& f) const;
};

// `after_latch` has the mean time (s) that each part and phase took after the latch; the times sum
// to the loop's delay. `device_damping` is the device's without the hand's, N·s/m. Absent for a
// delay of more than kMostSamples periods.
inline constexpr double kMostSamples = 16;
std::optional<StiffnessBudget> stiffness_budget(const plant::WallLoop& loop, double device_damping,
                                                std::vector<StiffnessBudget::Share> after_latch);

// The terminal's section on the closed loop of each device with mass.
std::string loop_text(const Outcome& outcome);

// The terminal's section on the cost of latency in stiffness; empty without a budget.
std::string stiffness_text(const std::optional<StiffnessBudget>& budget);

}  // namespace hvp::results
