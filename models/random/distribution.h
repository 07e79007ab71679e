#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"
#include "models/random/draws.h"

namespace hvp::random {

// One point of a published distribution: this share of the times is longer.
struct Exceedance {
  double share = 1;  // 1 at the shortest time, and never 0
  double time_s = 0;
};

// How a time is distributed: the tables of effects that draw one, such as [host.jitter]. Times in
// s, none below zero.
struct TimeDistribution {
  enum class Kind { constant, uniform, normal, exponential, lognormal, measured, published };

  // Where the defaults come from, and what a table says of itself; they differ from one to another.
  struct Sources {
    std::string_view kind =
        "assumed: no figure published for QuaRC; many short delays, few long ones";
    std::string_view mean = "assumed; real-time extensions lie between 2 and 20 us";
    std::string_view minimum = "nothing ends before now";
    std::string_view maximum = "assumed: half a period at 500 Hz";
    // What of a measured time the model counts by itself; none: nothing, and there is no such key.
    std::string_view counted = {};
    // The hosts of which a distribution has been published, in the order of `host`, and where;
    // none: the table has no such kind.
    std::vector<std::string_view> hosts = {};
    std::string_view host = {};
  };

  Kind kind = Kind::exponential;
  double mean_s = 5e-6;    // constant: the value; exponential: above minimum
  double deviation_s = 0;  // normal
  double median_s = 0;     // lognormal
  double spread = 0;       // lognormal: e^σ, the geometric standard deviation
  double minimum_s = 0;
  double maximum_s = 1e-3;
  config::File samples_file;  // measured

  double counted_s = 0;  // measured, published: what of each time is subtracted
  std::size_t host = 0;  // published: which of Sources::hosts

  std::vector<double> samples_s;  // what the file holds
  // published: the shares fall, the times do not; filled by the part whose table it is. Between two
  // points ln time is linear in ln share, a power law, so that a tail known at two points is one;
  // beyond the last point every time is the last one's.
  std::vector<Exceedance> points;

  void declare(config::Visitor& v) { declare(v, Sources{}); }
  void declare(config::Visitor& v, const Sources& sources);
  // Throws InputError where a parameter is missing, or leaves so little between minimum and maximum
  // that less than a third of the draws would lie there.
  void check() const;
  // Takes what the file holds. Throws InputError where a time is shorter than what is subtracted.
  void take(std::vector<double> samples);
};

const char* name(TimeDistribution::Kind kind);

// Where an effect draws its times, and, where it is there, of which kind: "at each interrupt,
// normal".
template <class Distribution>
std::string drawn(std::string_view where, const std::optional<Distribution>& effect) {
  std::string text(where);
  if (effect) text += std::string(", ") + name(effect->kind);
  return text;
}

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
  double published(double share) const;

  double log_spread_ = 0;
  std::vector<double> log_share_;  // of the distribution's points
  std::vector<double> log_time_;
};

}  // namespace hvp::random
