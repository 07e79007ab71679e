#include "models/tissue/prony.h"

#include <cmath>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::tissue {
namespace {

// From far below a frame to days: beyond, a time is a slip of the pen.
constexpr double kShortestTime = 1e-6;  // s
constexpr double kLongestTime = 1e6;    // s
// Shares that are written in decimals add up to one only nearly.
constexpr double kShareRounding = 1e-9;

}  // namespace

void PronyTerm::declare(config::Visitor& v) {
  v.quantity("share", share, config::Dimension::dimensionless, config::between(0, 1),
             {"of the force at once that relaxes away", "0: nothing does"});
  v.quantity(
      "time", time_s, config::Dimension::time, config::between(kShortestTime, kLongestTime),
      {"after which e⁻¹ of that share is left", "of the order in which soft tissue relaxes"});
}

void check_prony(std::span<const PronyTerm> terms) {
  double sum = 0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (!(terms[i].share >= 0) || !(terms[i].share <= 1)) {
      throw InputError(fmt::format("prony[{}].share", i),
                       fmt::format("the share is {}; expected 0 to 1", terms[i].share));
    }
    if (!(terms[i].time_s >= kShortestTime) || !(terms[i].time_s <= kLongestTime)) {
      throw InputError(fmt::format("prony[{}].time", i),
                       fmt::format("the time is {} s; expected {} s to {} s", terms[i].time_s,
                                   kShortestTime, kLongestTime));
    }
    sum += terms[i].share;
  }
  if (sum > 1 + kShareRounding) {
    throw InputError("prony", fmt::format("the shares add up to {}; expected at most 1", sum));
  }
}

PronySeries::PronySeries(std::span<const PronyTerm> terms, double step_s) {
  check_prony(terms);
  if (!(step_s > 0) || !std::isfinite(step_s)) {
    throw InputError(fmt::format("a step of {} s; expected a finite one above 0", step_s));
  }
  for (const PronyTerm& term : terms) {
    const double relaxed = -std::expm1(-step_s / term.time_s);
    steps_.push_back({.decay = std::exp(-step_s / term.time_s),
                      .gain = term.share * relaxed * (term.time_s / step_s)});
    remaining_ -= term.share;
  }
  if (remaining_ < 0) remaining_ = 0;
  stiffness_factor_ = remaining_;
  for (const Step& step : steps_) stiffness_factor_ += step.gain;
}

}  // namespace hvp::tissue
