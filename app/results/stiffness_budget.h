#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/plant/wall_stability.h"
#include "vp/frame/frame.h"

namespace hvp::results {

// The ledger of time as a ledger of stiffness: with a force that is L late, the stiffest wall that
// device and hand can stand before them (models/plant/wall_stability.h), and what each part of L
// costs of it.
struct StiffnessBudget {
  struct Share {
    std::string_view part;
    std::string_view phase;
    double time_s = 0;  // mean, after the latch
    double cost_N_m = 0;
  };

  // L: from the latch to the force at the motor, the mean of the frames in contact; of all where
  // there was none.
  double delay_s = 0;
  double period_s = 0;     // T
  double stable_N_m = 0;   // by the exact eigenvalues
  double passive_N_m = 0;  // b/(T/2 + L)
  double without_delay_N_m = 0;
  std::vector<Share> shares;  // largest cost first

  void report(config::Figures& f) const;
};

// `after_latch`: of each part and phase, the mean time (s) that it took after the latch; they sum
// to the loop's delay. `device_damping`: without the hand's, N·s/m. None for a delay of more than
// kMostSamples periods.
inline constexpr double kMostSamples = 16;
std::optional<StiffnessBudget> stiffness_budget(const plant::WallLoop& loop, double device_damping,
                                                std::vector<StiffnessBudget::Share> after_latch);

}  // namespace hvp::results
