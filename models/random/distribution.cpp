#include "models/random/distribution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/random/survival.h"
#include "models/random/tilt.h"

namespace hvp::random {

namespace {

using config::Dimension;
using Kind = TimeDistribution::Kind;

constexpr double kLongest = TimeDistribution::kLongest;
// A shape so near to zero draws what a shape of zero does, to six digits.
constexpr double kNoShape = 1e-8;
// At least a third of the draws are accepted, so that this many rejections in a row do not happen.
constexpr std::uint32_t kAttempts = 1000;

std::string microseconds(double seconds) { return fmt::format("{:g} us", seconds * 1e6); }

}  // namespace

const char* name(Kind kind) {
  switch (kind) {
    case Kind::constant:
      return "constant";
    case Kind::uniform:
      return "uniform";
    case Kind::normal:
      return "normal";
    case Kind::exponential:
      return "exponential";
    case Kind::lognormal:
      return "lognormal";
    case Kind::measured:
      return "measured";
    case Kind::published:
      return "published";
  }
  return "";
}

void TimeDistribution::declare(config::Visitor& v, const Sources& sources) {
  std::vector<std::pair<std::string_view, Kind>> kinds;
  for (const Kind k : {Kind::constant, Kind::uniform, Kind::normal, Kind::exponential,
                       Kind::lognormal, Kind::measured}) {
    kinds.emplace_back(name(k), k);
  }
  const bool has_hosts = !sources.hosts.empty();
  if (has_hosts) kinds.emplace_back(name(Kind::published), Kind::published);
  const auto of_kind = v.variant(
      "distribution", kind, kinds,
      {has_hosts ? "how the time is distributed; measured: drawn from the user's own samples; "
                   "published: as measured on a host by others"
                 : "how the time is distributed; measured: drawn from the user's own samples",
       sources.kind});
  of_kind.only({Kind::constant, Kind::normal, Kind::exponential}, [&] {
    v.quantity("mean", mean_s, Dimension::time, config::between(0, kLongest),
               {"constant: the time; normal: its mean; exponential: its mean above minimum",
                sources.mean});
  });
  of_kind.only({Kind::normal}, [&] {
    v.quantity("deviation", deviation_s, Dimension::time, {0, kLongest, true},
               {.help = "standard deviation before it is cut off", .required = true});
  });
  of_kind.only({Kind::lognormal}, [&] {
    v.quantity("median", median_s, Dimension::time, {0, kLongest, true},
               {.help = "the median", .required = true});
    v.quantity("spread", spread, Dimension::dimensionless, config::between(1, 1000),
               {.help = "geometric standard deviation; two thirds lie between median/spread and "
                        "median*spread",
                .required = true});
  });
  of_kind.only({Kind::uniform, Kind::normal, Kind::exponential, Kind::lognormal}, [&] {
    v.quantity("minimum", minimum_s, Dimension::time, config::between(0, kLongest),
               {"no time is shorter: what is drawn below is drawn again", sources.minimum});
    v.quantity("maximum", maximum_s, Dimension::time, config::between(0, kLongest),
               {"no time is longer: what is drawn above is drawn again", sources.maximum});
  });
  of_kind.only({Kind::measured}, [&] {
    v.file(
        "samples", samples_file,
        {.help = "a CSV file with a column of latencies, such as latency_us, and, if it has one, "
                 "count; or what cyclictest -h prints",
         .required = true});
    if (!sources.counted.empty()) {
      v.quantity("counted", counted_s, Dimension::time, config::between(0, kLongest),
                 {"what of each measured time the model counts by itself, and is subtracted",
                  sources.counted});
    }
    const auto of_tail =
        v.variant("tail", tail, {{"measured", Tail::measured}, {"pareto", Tail::pareto}},
                  {"the longest times; pareto: drawn from a generalised Pareto distribution, whose "
                   "parameters `hvp fit --model host --set distribution=measured` finds",
                   "no time is longer than was measured"});
    of_tail.only({Tail::pareto}, [&] {
      v.quantity("tail_from", tail_from_s, Dimension::time, {0, kLongest, true},
                 {.help = "the samples from here on stand for the tail", .required = true});
      v.quantity("tail_scale", tail_scale_s, Dimension::time, {0, kLongest, true},
                 {.help = "scale of the times above tail_from", .required = true});
      v.quantity("tail_shape", tail_shape, Dimension::dimensionless, config::between(-0.5, 1),
                 {.help = "shape: 0 falls exponentially, above it is a power law, below it ends",
                  .required = true});
    });
  });
  if (!has_hosts) return;
  of_kind.only({Kind::published}, [&] {
    v.choice_index("host", host, sources.hosts, {"whose times are drawn", sources.host});
  });
}

void TimeDistribution::check() const {
  if (maximum_s < minimum_s) {
    throw InputError("maximum", fmt::format("expected at least minimum = {}, found {}",
                                            microseconds(minimum_s), microseconds(maximum_s)));
  }
  const double width = maximum_s - minimum_s;
  const auto inside = [&](const char* key, double centre) {
    if (centre >= minimum_s && centre <= maximum_s) return;
    throw InputError(
        key, fmt::format("expected between minimum = {} and maximum = {}, found {}",
                         microseconds(minimum_s), microseconds(maximum_s), microseconds(centre)));
  };
  const auto at_least_wide = [&](const char* key, double scale) {
    if (scale <= width) return;
    throw InputError(key, fmt::format("expected at most maximum - minimum = {}, found {}: fewer "
                                      "than a third of the draws would lie between",
                                      microseconds(width), microseconds(scale)));
  };
  if (kind == Kind::normal) {
    if (!(deviation_s > 0)) {
      throw InputError("deviation", "a normal distribution needs it above 0 s");
    }
    inside("mean", mean_s);
    at_least_wide("deviation", deviation_s);
  }
  if (kind == Kind::exponential) at_least_wide("mean", mean_s);
  if (kind == Kind::lognormal) {
    if (!(median_s > 0)) throw InputError("median", "a lognormal distribution needs it above 0 s");
    if (!(spread >= 1)) throw InputError("spread", "a lognormal distribution needs it, 1 or more");
    inside("median", median_s);
    if (median_s * spread > maximum_s && median_s / spread < minimum_s) {
      throw InputError("spread",
                       fmt::format("expected median*spread within maximum = {} or median/spread "
                                   "within minimum = {}: fewer than a third of the draws would "
                                   "lie between",
                                   microseconds(maximum_s), microseconds(minimum_s)));
    }
  }
  if (kind == Kind::measured && samples_file.empty()) {
    throw InputError("samples", "distribution = \"measured\" needs a CSV file of samples");
  }
  if (kind == Kind::measured && tail == Tail::pareto && !(tail_scale_s > 0)) {
    throw InputError("tail_scale", "a tail needs it above 0 s");
  }
}

double TimeDistribution::tail_above(double seconds) const {
  const double y = (seconds - tail_from_s) / tail_scale_s;
  if (std::abs(tail_shape) < kNoShape) return std::exp(-y);
  const double base = 1 + tail_shape * y;
  return base > 0 ? std::pow(base, -1 / tail_shape) : 0;
}

void TimeDistribution::take(std::vector<double> samples, std::vector<std::int64_t> counts) {
  const auto shortest = std::min_element(samples.begin(), samples.end());
  if (shortest != samples.end() && *shortest < counted_s) {
    throw InputError("counted", fmt::format("expected at most the shortest sample, {}, found {}",
                                            microseconds(*shortest), microseconds(counted_s)));
  }
  if (tail == Tail::pareto && tail_from_s < counted_s) {
    throw InputError("tail_from", fmt::format("expected at least counted = {}, found {}",
                                              microseconds(counted_s), microseconds(tail_from_s)));
  }
  if (tail == Tail::pareto &&
      std::ranges::none_of(samples, [this](double s) { return in_tail(s); })) {
    throw InputError("tail_from", fmt::format("expected at most the longest sample, {}, found {}",
                                              microseconds(*std::ranges::max_element(samples)),
                                              microseconds(tail_from_s)));
  }
  samples_s = std::move(samples);
  sample_counts = std::move(counts);
}

Source::Source(TimeDistribution distribution, std::int64_t seed, std::string_view effect)
    : distribution_(std::move(distribution)), draws_(seed, effect) {
  if (distribution_.kind == Kind::lognormal) log_spread_ = natural_log(distribution_.spread);
  if (distribution_.kind == Kind::measured && distribution_.samples_s.empty()) {
    throw std::logic_error("a measured distribution without its samples");
  }
  if (distribution_.tilt != nullptr && distribution_.kind != Kind::constant) {
    survival_ = std::make_shared<Survival>(distribution_);
    effect_ = distribution_.tilt->join(effect);
  }
  std::int64_t sum = 0;
  for (const std::int64_t count : distribution_.sample_counts) seen_.push_back(sum += count);
  if (distribution_.kind != Kind::published) return;
  const std::vector<Exceedance>& points = distribution_.points;
  if (points.size() < 2 || points.front().share != 1) {
    throw std::logic_error("a published distribution without its points");
  }
  for (const Exceedance& point : points) {
    log_share_.push_back(natural_log(point.share));
    log_time_.push_back(natural_log(point.time_s));
  }
}

// The time that this share of all times exceeds, s.
double Source::published(double share) const {
  const double log_share = natural_log(share);
  std::size_t next = 1;
  while (next + 1 < log_share_.size() && log_share_[next] > log_share) ++next;
  const double part =
      std::min(1.0, (log_share_[next - 1] - log_share) / (log_share_[next - 1] - log_share_[next]));
  return exponential(log_time_[next - 1] + part * (log_time_[next] - log_time_[next - 1]));
}

// The time that this share of the tail's times exceeds, s.
double Source::tail_time(double share) const {
  const TimeDistribution& d = distribution_;
  const double log_share = natural_log(share);
  if (std::abs(d.tail_shape) < kNoShape) return d.tail_from_s - d.tail_scale_s * log_share;
  return d.tail_from_s +
         d.tail_scale_s / d.tail_shape * (exponential(-d.tail_shape * log_share) - 1);
}

// False where the draw is to be made again.
bool Source::attempt(const Draws::Pair& u, double& value) const {
  const TimeDistribution& d = distribution_;
  switch (d.kind) {
    case Kind::constant:
      value = d.mean_s;
      return true;
    case Kind::uniform:
      value = d.minimum_s + u.first * (d.maximum_s - d.minimum_s);
      return true;
    case Kind::measured: {
      const auto count = static_cast<double>(
          seen_.empty() ? d.samples_s.size() : static_cast<std::size_t>(seen_.back()));
      auto index = static_cast<std::size_t>(u.first * count);
      if (!seen_.empty()) {
        // The sample that is seen as the index-th one, where each is seen count times in a row.
        const auto at = std::ranges::upper_bound(seen_, static_cast<std::int64_t>(index));
        index = static_cast<std::size_t>(at - seen_.begin());
      }
      value = d.samples_s[std::min(index, d.samples_s.size() - 1)];
      if (d.in_tail(value)) value = tail_time(u.second);
      if (value > kLongest) return false;
      value -= d.counted_s;
      return true;
    }
    case Kind::published:
      value = published(u.first) - d.counted_s;
      return true;
    case Kind::exponential:
      value = d.minimum_s - d.mean_s * natural_log(u.first);
      break;
    case Kind::normal:
    case Kind::lognormal: {
      // Marsaglia's polar method: a point in the unit disc. One of the two numbers is enough.
      const double x = 2 * u.first - 1;
      const double y = 2 * u.second - 1;
      const double square = x * x + y * y;
      if (square >= 1 || square == 0) return false;
      const double z = x * std::sqrt(-2 * natural_log(square) / square);
      value = d.kind == Kind::normal ? d.mean_s + d.deviation_s * z
                                     : d.median_s * exponential(log_spread_ * z);
      break;
    }
  }
  return value >= d.minimum_s && value <= d.maximum_s;
}

double Source::time_s(std::int64_t frame, std::uint32_t draw) const {
  if (survival_ && distribution_.tilt->touches(effect_, draw)) {
    const double uniform = draws_.uniform(frame, draw, kAttempts).first;
    return survival_->quantile(distribution_.tilt->share(effect_, frame, draw, uniform));
  }
  double value = 0;
  for (std::uint32_t n = 0; n < kAttempts; ++n) {
    if (attempt(draws_.uniform(frame, draw, n), value)) return value;
  }
  throw std::logic_error("a distribution of which nothing lies within its bounds");
}

namespace {
// ln 2 as a sum whose first term has 32 zeros at its end: its product with an exponent is exact.
constexpr double kLn2High = 0x1.62e42feep-1;
constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
constexpr double kSqrtHalf = 0x1.6a09e667f3bcdp-1;
}  // namespace

// x = 2^k·m with m in [√½, √2), and ln m = 2·artanh((m − 1)/(m + 1)).
double natural_log(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < kSqrtHalf) {
    m *= 2;
    --exponent;
  }
  const double s = (m - 1) / (m + 1);  // |s| < 0.172
  const double square = s * s;
  double series = 0;
  for (int power = 23; power >= 3; power -= 2) series = (series + 1.0 / power) * square;
  const double k = exponent;
  return k * kLn2High + (2 * s + (2 * s * series + k * kLn2Low));
}

// x = k·ln 2 + r with |r| ≤ ½·ln 2, and Taylor's series for e^r.
double exponential(double x) {
  const double k = std::round(x / (kLn2High + kLn2Low));
  const double r = (x - k * kLn2High) - k * kLn2Low;
  double series = 1;
  for (int n = 14; n >= 1; --n) series = 1 + r / n * series;
  return std::ldexp(series, static_cast<int>(k));
}

}  // namespace hvp::random
