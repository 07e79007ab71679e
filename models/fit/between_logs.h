#pragma once

#include <span>

namespace hvp::fit {

// A parameter as one log gives it, with the standard deviation of that estimate.
struct OfOneLog {
  double value = 0;
  double deviation = 0;
};

// A parameter as several logs give it, each of which may differ from the others by more than its
// own noise tells: another day, another temperature, another grip.
struct BetweenLogs {
  double value = 0;
  // The 95 % interval of that value, over all the logs that might have been recorded.
  double low = 0;
  double high = 0;
  // The standard deviation of the logs' true values, which their own deviations do not explain.
  double deviation = 0;
  // What the fit of another log of the same kind would give, 95 %, with the noise of a log like
  // these.
  double next_low = 0;
  double next_high = 0;
  // Of so much disagreement among logs that differ by their own noise alone (Cochran 1954).
  double probability = 1;
};

// The random-effects model of a meta-analysis: value = mean + what is the log's + noise. The
// variance between logs is Paule and Mandel's (1982): Σ wᵢ·(vᵢ − v)² = k − 1 with
// wᵢ = 1/(sᵢ² + τ²), or zero. The interval has Student's distribution with k − 1 degrees of freedom
// and is not narrower than the weights say (Hartung & Knapp 2001; Röver et al. 2015). Two logs know
// little of what lies between logs: their interval is 6.5 times as wide as a normal one. Needs two
// logs, with positive deviations.
BetweenLogs between_logs(std::span<const OfOneLog> logs);

}  // namespace hvp::fit
