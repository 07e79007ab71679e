#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"

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
  // Throws InputError where a parameter is missing, belongs to another distribution, or leaves so
  // little between minimum and maximum that less than a third of the draws would lie there.
  void check() const;
};

const char* name(TimeDistribution::Kind kind);

// Draws for one effect. A draw depends on the seed, the effect's name, the frame and which draw of
// the frame it is; on nothing that was drawn before. An effect that is taken away, or a frame that
// is skipped, leaves all other draws as they are.
class Source {
 public:
  Source(TimeDistribution distribution, std::int64_t seed, std::string_view effect);

  // s. `draw` counts the draws of a frame, below 2^16.
  double time_s(std::int64_t frame, std::uint32_t draw = 0) const;

 private:
  // Two numbers in (0, 1) with 53 bits each.
  struct Pair {
    double first;
    double second;
  };
  Pair uniform(std::int64_t frame, std::uint32_t draw, std::uint32_t attempt) const;
  bool attempt(const Pair& u, double& value) const;

  TimeDistribution distribution_;
  std::uint64_t seed_;
  std::uint32_t effect_;
  double log_spread_ = 0;
};

}  // namespace hvp::random
