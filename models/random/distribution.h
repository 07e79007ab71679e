#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"
#include "models/random/draws.h"

namespace hvp::random {

// How a time is distributed: the tables of effects that draw one, such as [host.jitter]. Times in
// s, none below zero.
struct TimeDistribution {
  enum class Kind { constant, uniform, normal, exponential, lognormal, measured };

  Kind kind = Kind::exponential;
  double mean_s = 5e-6;    // constant: the value; exponential: above minimum
  double deviation_s = 0;  // normal
  double median_s = 0;     // lognormal
  double spread = 0;       // lognormal: e^σ, the geometric standard deviation
  double minimum_s = 0;
  double maximum_s = 1e-3;
  std::string samples_file;  // measured

  // What the file holds; filled by whoever reads it.
  std::vector<double> samples_s;

  void declare(config::Visitor& v);
  // Throws InputError where a parameter is missing, or leaves so little between minimum and maximum
  // that less than a third of the draws would lie there.
  void check() const;
};

const char* name(TimeDistribution::Kind kind);

// Times for one effect: each a function of what Draws names.
class Source {
 public:
  Source(TimeDistribution distribution, std::int64_t seed, std::string_view effect);

  // s. `draw` counts the draws of a frame, below 2^16.
  double time_s(std::int64_t frame, std::uint32_t draw = 0) const;

 private:
  bool attempt(const Draws::Pair& u, double& value) const;

  TimeDistribution distribution_;
  Draws draws_;
  double log_spread_ = 0;
};

}  // namespace hvp::random
