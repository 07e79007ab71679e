#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/declaration.h"
#include "models/random/draws.h"

namespace hvp::random {

class Survival;
class Tilt;

// One point of a published distribution: the share of the times that are longer than `time_s`.
struct Exceedance {
  double share = 1;  // 1 at the shortest time, and never 0
  double time_s = 0;
};

// The distribution of a time, for the tables of effects that draw one, such as [host.jitter]. Times
// are in s, none below zero.
struct TimeDistribution {
  enum class Kind { constant, uniform, normal, exponential, lognormal, measured, published };
  // How the longest measured times are drawn: as the samples they are, or from a generalised Pareto
  // distribution that a fit found of them.
  enum class Tail { measured, pareto };
  static constexpr double kLongest = 1;  // s; no time is longer

  // The sources of the defaults, and the texts that differ from one table to another.
  struct Sources {
    std::string_view kind =
        "assumed: no figure published for QuaRC; many short delays, few long ones";
    std::string_view mean = "assumed; real-time extensions lie between 2 and 20 us";
    std::string_view minimum = "nothing ends before now";
    std::string_view maximum = "assumed: half a period at 500 Hz";
    // The part of a measured time that the model counts by itself; empty: there is none, and no
    // such key.
    std::string_view counted = {};
    // The hosts with a published distribution, in the order of `host`, and its source; empty: the
    // table has no such kind.
    std::vector<std::string_view> hosts = {};
    std::string_view host = {};
  };

  Kind kind = Kind::exponential;
  double mean_s = 5e-6;    // constant: the value; exponential: the mean above minimum
  double deviation_s = 0;  // normal
  double median_s = 0;     // lognormal
  double spread = 0;       // lognormal: e^σ, the geometric standard deviation
  double minimum_s = 0;
  double maximum_s = 1e-3;
  config::File samples_file;  // measured

  // measured: the samples from `tail_from_s` on stand for tail_from_s + y, where the share of the y
  // above t is (1 + shape·t/scale)^(−1/shape), with a shape of 0 e^(−t/scale) (Pickands, Annals of
  // Statistics 3, 1975).
  Tail tail = Tail::measured;
  double tail_from_s = 0;
  double tail_scale_s = 0;
  double tail_shape = 0;

  double counted_s = 0;  // measured, published: the part of each time that is subtracted
  std::size_t host = 0;  // published: index into Sources::hosts

  // Long times are drawn more often, and it tells by how much; null: as often as they come. Has to
  // outlive every source.
  Tilt* tilt = nullptr;

  std::vector<double> samples_s;            // the file's times
  std::vector<std::int64_t> sample_counts;  // how often each was seen; empty: once
  // published: the points, with falling shares and times that do not fall; filled by the part whose
  // table it is. Between two points ln time is linear in ln share, a power law, so that a tail
  // known at two points is one; beyond the last point every time is the last one's.
  std::vector<Exceedance> points;

  void declare(config::Visitor& v) { declare(v, Sources{}); }
  void declare(config::Visitor& v, const Sources& sources);
  // Throws InputError where a parameter is missing, or leaves so little between minimum and maximum
  // that less than a third of the draws would lie there.
  void check() const;
  // True of a sample, in s, that stands for the tail.
  bool in_tail(double sample_s) const { return tail == Tail::pareto && sample_s >= tail_from_s; }
  // The share of the tail's times that are longer than `seconds`, at least tail_from_s.
  double tail_above(double seconds) const;
  // Takes the file's times and how often each was seen. Throws InputError where one is shorter than
  // the part that is subtracted, or none is in the tail.
  void take(std::vector<double> samples, std::vector<std::int64_t> counts = {});
};

const char* name(TimeDistribution::Kind kind);

// The text that says where an effect draws its times and, where the effect is present, from which
// kind of distribution: "at each interrupt, normal".
template <class Distribution>
std::string drawn(std::string_view where, const std::optional<Distribution>& effect) {
  std::string text(where);
  if (effect) text += std::string(", ") + name(effect->kind);
  return text;
}

// The source of one effect's times. Each time is a function of the arguments of Draws alone.
class Source {
 public:
  Source(TimeDistribution distribution, std::int64_t seed, std::string_view effect);

  // The time, s. `draw` counts the draws of a frame, below 2^16.
  double time_s(std::int64_t frame, std::uint32_t draw = 0) const;

 private:
  bool attempt(const Draws::Pair& u, double& value) const;

  TimeDistribution distribution_;
  Draws draws_;
  // With a tilt.
  std::shared_ptr<const Survival> survival_;
  std::size_t effect_ = 0;
  double published(double share) const;
  double tail_time(double share) const;

  double log_spread_ = 0;
  std::vector<std::int64_t> seen_;  // measured with counts: how many up to and with each sample
  std::vector<double> log_share_;   // of the distribution's points
  std::vector<double> log_time_;
};

// The natural logarithm and exponential by series in IEEE 754's four operations. A C library's own
// functions differ in the last bit from one version or processor to the next, and a draw would with
// them. The error is below 4 units in the last place; tests/random compares.

// The natural logarithm of a positive normal number.
double natural_log(double x);

// The exponential of a number from −700 to 700.
double exponential(double x);

}  // namespace hvp::random
