#include "vp/frame/late_probability.h"

#include <algorithm>
#include <cmath>

#include "models/random/tail_region.h"
#include "models/statistics/proportion.h"

namespace hvp::vp {

namespace {

constexpr std::size_t kCells = std::size_t{1} << 15U;
// A frame wakes its process once or twice; a contact that moves, a recovery or a missed poll adds
// one. Frames with other numbers are counted as left out.
constexpr std::size_t kMostCombinations = 8;
// Of fewer pairs a dependence does not show. So large a share of all frames has to be seen.
constexpr std::int64_t kFewest = 40;
constexpr double kTested = 0.9;
// Chance goes there less than once in 30 million runs.
constexpr double kDependent = 6;
// A rest that moves by less of what the drawn times do changes a probability no more than a drawn
// time that is off by as much.
constexpr double kMatters = 0.01;

// A constant time is part of the rest.
template <class Distribution>
std::optional<random::Survival> survival_of(const std::optional<Distribution>& effect) {
  if (!effect || effect->kind == random::TimeDistribution::Kind::constant) return std::nullopt;
  return random::Survival(*effect);
}

template <class Distribution>
std::optional<random::TimeDistribution> tailed(const std::optional<Distribution>& effect) {
  if (!effect || effect->kind != random::TimeDistribution::Kind::measured ||
      effect->tail != random::TimeDistribution::Tail::pareto) {
    return std::nullopt;
  }
  return *effect;
}

}  // namespace

bool LateProbability::applies(const host::Host& host) {
  return survival_of(host.jitter) || survival_of(host.wake_up) ||
         survival_of(host.interrupt_latencies);
}

LateProbability::LateProbability(const host::Host& host, Picoseconds budget)
    : budget_(budget),
      cell_((budget + static_cast<Picoseconds>(kCells) - 2) /
            (static_cast<Picoseconds>(kCells) - 1)),
      survivals_{survival_of(host.jitter), survival_of(host.wake_up),
                 survival_of(host.interrupt_latencies)},
      tailed_{tailed(host.jitter), tailed(host.wake_up), tailed(host.interrupt_latencies)},
      combinations_(kMostCombinations) {
  for (Combination& c : combinations_) {
    c.cells.resize(kCells);
    c.places.resize(kCells);
  }
}

void LateProbability::Pairs::add(std::int64_t frame, double rest_ps, double drawn_ps) {
  First& other = first[static_cast<std::size_t>(frame % kLag)];
  if (frame / kLag % 2 == 0) {
    other = {frame, rest_ps, drawn_ps};
    return;
  }
  const double longer = drawn_ps - other.drawn;
  if (other.frame != frame - kLag || longer == 0) return;
  const double difference = rest_ps - other.rest;
  ++count;
  aligned += longer > 0 ? difference : -difference;
  squares += difference * difference;
  drawn += std::abs(longer);
}

// By Hoeffding's inequality (J. Am. Stat. Assoc. 58, 1963) random signs go beyond z·√squares in
// less than 2·e^(−z²/2) of all cases.
bool LateProbability::Pairs::dependent() const {
  return std::abs(aligned) > kDependent * std::sqrt(squares) &&
         std::abs(aligned) > kMatters * drawn;
}

LateProbability::Combination* LateProbability::of(const Draws& draws) {
  const auto end = combinations_.begin() + static_cast<std::ptrdiff_t>(used_);
  const auto known =
      std::find_if(combinations_.begin(), end, [&](const auto& c) { return c.draws == draws; });
  if (known != end) return &*known;
  if (used_ == combinations_.size()) return nullptr;
  combinations_[used_].draws = draws;
  return &combinations_[used_++];
}

void LateProbability::closed(const Frame& frame, const CriticalPath& path) {
  if (!frame.solved()) {
    ++left_out_;
    return;
  }
  // Whether the process slept hangs on the time of its release, which then is not any of its
  // distribution. Such a frame is counted as it was.
  if (frame.beyond_tick && survivals_.front()) {
    ++as_run_;
    if (frame.latency() > budget_) ++late_as_run_;
    return;
  }
  Draws draws{};
  Picoseconds drawn = 0;
  for (const SpanId id : path.spans()) {
    const Span& span = frame.spans[static_cast<std::size_t>(id)];
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      if (span.phase != kPhasesOf[kind] || !survivals_[kind]) continue;
      // Then the frame before is what it waited for.
      if (span.phase == Phase::release && frame.not_woken) continue;
      ++draws[kind];
      drawn += span.end - span.start;
    }
  }
  Combination* const c = of(draws);
  if (c == nullptr) {
    ++left_out_;
    return;
  }
  const Picoseconds rest = frame.latency() - drawn;
  if (!frame.beyond_tick) {
    c->pairs.add(frame.number, static_cast<double>(rest), static_cast<double>(drawn));
  }
  ++c->frames;
  if (rest > budget_) {
    ++c->beyond;
    return;
  }
  const auto cell = static_cast<std::size_t>(rest / cell_);
  ++c->cells[cell];
  c->places[cell] += static_cast<double>(rest % cell_) / static_cast<double>(cell_);
}

std::optional<LateProbability::Result> LateProbability::result() const {
  Result result;
  result.left_out = left_out_;
  result.frames = as_run_;
  std::int64_t tested = as_run_;
  for (std::size_t k = 0; k < used_; ++k) {
    const Combination& c = combinations_[k];
    result.frames += c.frames;
    if (c.draws == Draws{} || c.pairs.count >= kFewest) tested += c.frames;
    result.dependent = result.dependent || c.pairs.dependent();
  }
  if (result.frames == 0) return std::nullopt;
  result.untested = static_cast<double>(tested) < kTested * static_cast<double>(result.frames);
  result.late = late_with(survivals_);
  if (result.known())
    result.by_tail = by_tail(result.late.share, static_cast<double>(result.frames));
  using statistics::Rounding;
  const auto frames = static_cast<double>(result.frames);
  result.late = {rounded_share(result.late.low / frames, Rounding::down),
                 rounded_share(result.late.share / frames, Rounding::nearest),
                 rounded_share(result.late.high / frames, Rounding::up)};
  if (result.by_tail) {
    result.by_tail = {rounded_share(result.by_tail->low / frames, Rounding::down),
                      rounded_share(std::min(1.0, result.by_tail->high / frames), Rounding::up)};
  }
  return result;
}

std::optional<LateProbability::Result::Interval> LateProbability::by_tail(double late,
                                                                          double frames) const {
  // The transforms tell no smaller share from none.
  const double told = 1e-13 * frames;
  random::LeftOpen all;
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    if (!tailed_[kind]) continue;
    Survivals survivals = survivals_;
    const random::LeftOpen open = random::left_open(
        *tailed_[kind],
        [&](const random::TimeDistribution& tail) {
          survivals[kind].emplace(tail);
          return late_with(survivals).share;
        },
        told);
    all.below += open.below;
    all.above += open.above;
    all.to_zero = all.to_zero || open.to_zero;
  }
  if (!(all.above > 0)) return std::nullopt;
  const double known = std::max(late, told);
  return Result::Interval{all.to_zero ? 0 : known * std::exp(-std::sqrt(all.below)),
                          known * std::exp(std::sqrt(all.above))};
}

statistics::SumOfTimes::Share LateProbability::late_with(const Survivals& survivals) const {
  statistics::SumOfTimes::Share late;
  const auto add = [&late](double count, const statistics::SumOfTimes::Share& share) {
    late.low += count * share.low;
    late.share += count * share.share;
    late.high += count * share.high;
  };
  add(static_cast<double>(late_as_run_), {1, 1, 1});
  const double cell_s = to_seconds(cell_);
  for (std::size_t k = 0; k < used_; ++k) {
    const Combination& c = combinations_[k];
    add(static_cast<double>(c.beyond), {1, 1, 1});
    // Where nothing was drawn they are late or not.
    if (c.draws == Draws{}) continue;
    statistics::SumOfTimes sum(cell_s, kCells);
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      if (survivals[kind]) sum.add(*survivals[kind], c.draws[kind]);
    }
    for (std::size_t cell = 0; cell < kCells; ++cell) {
      if (c.cells[cell] == 0) continue;
      // Where its frames lie in the cell is known in the mean; the bounds have both its ends.
      const auto count = static_cast<double>(c.cells[cell]);
      const double left_s = to_seconds(budget_ - static_cast<Picoseconds>(cell) * cell_);
      add(count, {sum.above(left_s).low, sum.above(left_s - c.places[cell] / count * cell_s).share,
                  sum.above(left_s - cell_s).high});
    }
  }
  return late;
}

void LateProbability::Result::report(config::Figures& f) const {
  f.truth("independent", known(),
          "the rest of a frame is as long where the drawn times are long as where they are short; "
          "else, and where too few frames tell, there is no probability");
  std::optional<double> share;
  std::optional<double> low;
  std::optional<double> high;
  if (known()) share = late.share, low = late.low, high = late.high;
  f.ratio("share", share, "the probability that a frame's force is late");
  f.ratio("low", low, "at least so much, by the grid of the convolution");
  f.ratio("high", high, "and at most so much");
  std::optional<double> tail_low;
  std::optional<double> tail_high;
  if (by_tail) tail_low = by_tail->low, tail_high = by_tail->high;
  f.ratio("tail_low", tail_low,
          "with a Pareto tail: at least so much with 95 %, by how well its samples tell it");
  f.ratio("tail_high", tail_high, "and at most so much");
  f.count("frames", frames, "over which it is the mean");
  f.count("left_out", left_out,
          "frames whose solve failed, and those with a ninth number of drawn times");
}

}  // namespace hvp::vp
