#include "app/results/stiffness_budget.h"

#include <algorithm>

namespace hvp::results {

std::optional<StiffnessBudget> stiffness_budget(const plant::WallLoop& loop, double device_damping,
                                                std::vector<StiffnessBudget::Share> after_latch) {
  if (loop.delay_s > kMostSamples * loop.period_s) return std::nullopt;
  StiffnessBudget b;
  b.delay_s = loop.delay_s;
  b.period_s = loop.period_s;
  b.stable_N_m = plant::largest_stable_stiffness(loop);
  b.passive_N_m = plant::passive_stiffness(loop, device_damping);
  plant::WallLoop at_once = loop;
  at_once.delay_s = 0;
  at_once.device.lag_rate = 0;
  b.without_delay_N_m = plant::largest_stable_stiffness(at_once);
  b.shares = std::move(after_latch);
  for (StiffnessBudget::Share& share : b.shares) {
    share.cost_N_m = plant::stiffness_cost(loop, share.time_s);
  }
  if (loop.device.lag_rate > 0) {
    plant::WallLoop without_lag = loop;
    without_lag.device.lag_rate = 0;
    b.shares.push_back({"device", "amplifier lag", 1 / loop.device.lag_rate,
                        plant::largest_stable_stiffness(without_lag) - b.stable_N_m});
  }
  std::ranges::stable_sort(b.shares, std::greater<>(), &StiffnessBudget::Share::cost_N_m);
  return b;
}

void StiffnessBudget::report(config::Figures& f) const {
  f.mean_time(
      "delay_us", delay_s * 1e12,
      "from the latch to the force at the motor, the mean of the frames in contact, or of all "
      "where there was none");
  f.quantity("stable_N_m", stable_N_m, "N/m",
             "the stiffest wall with which the loop is stable, by its exact eigenvalues at that "
             "delay");
  f.quantity("passive_N_m", passive_N_m, "N/m",
             "the stiffest passive one: the device's damping over half a period and that delay");
  f.quantity("without_delay_N_m", without_delay_N_m, "N/m", "stable, if no part took time");
  f.list("parts", "what each part of the delay costs; largest first", shares,
         [&f](const Share& share) {
           f.text("part", share.part, "which part of the system");
           f.text("phase", share.phase, "what it does");
           f.mean_time("mean_us", share.time_s * 1e12,
                       "its time after the latch; of an amplifier's lag the time constant");
           f.quantity("cost_N_m", share.cost_N_m, "N/m",
                      "by how much stiffer a wall could be if it took none");
         });
}

}  // namespace hvp::results
