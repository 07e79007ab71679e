#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/plant/wall_stability.h"
#include "models/stability/flag.h"
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
  // L: from the latch to the force at the motor, the mean of the frames in contact in which a force
  // changes, or of all frames where there are none; and the largest of them.
  double delay_s = 0;
  double worst_delay_s = 0;
  std::int64_t frames = 0;  // that those are of
  bool moving = false;      // false: no frame in contact had a force that changed
  double period_s = 0;      // T
  double stable_N_m = 0;    // by the exact eigenvalues
  double passive_N_m = 0;   // b/(T/2 + L)
  double edge_N_m = 0;      // stable with worst_delay_s
  double worst_passive_N_m = 0;
  double without_delay_N_m = 0;
  std::optional<double> contact_N_m;  // of the wall, or of the body at its contact
  std::vector<Share> shares;          // largest cost first
  // Whose device it is; absent where all have the same.
  std::optional<std::size_t> probe;

  // The gain margin: how many times stiffer the contact could be before the linear loop with the
  // worst delay is unstable. Absent where nothing moved in contact or the contact's stiffness is
  // not known.
  std::optional<double> margin() const;

  void report(config::Figures& f) const;
};

// What a run measured of its loop's delay.
struct MeasuredDelay {
  double worst_delay_s = 0;
  std::int64_t frames = 0;
  bool moving = false;
  std::optional<double> contact_N_m;
  // The device without the hand, where that lets go during the run.
  std::optional<plant::LinearAxis> let_go;
  // The mean time (s) that each part and phase took after the latch; they sum to the loop's delay.
  std::vector<StiffnessBudget::Share> after_latch;
};

// The budget of a loop with the mean delay. `device_damping` is the device's without the hand's,
// N·s/m. Absent for a worst delay of more than kMostSamples periods.
inline constexpr double kMostSamples = 16;
std::optional<StiffnessBudget> stiffness_budget(const plant::WallLoop& loop, double device_damping,
                                                MeasuredDelay measured);

// The flag low_gain_margin where the margin is known and less than `least`, or none.
stability::Flags margin_flags(const std::optional<StiffnessBudget>& budget, double least);

// The terminal's section on the closed loop of each device with mass.
std::string loop_text(const Outcome& outcome);

// The terminal's section on the cost of latency in stiffness; empty without a budget.
std::string stiffness_text(const std::optional<StiffnessBudget>& budget);

}  // namespace hvp::results
