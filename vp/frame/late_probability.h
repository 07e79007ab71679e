#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/config/figures.h"
#include "models/host/costs.h"
#include "models/random/distribution.h"
#include "models/random/survival.h"
#include "models/statistics/sum_of_times.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// How probable it is that a frame's force is late, where the operating system's times are drawn:
// far beyond what the run's own frames could show. Of each frame the ledger tells what its critical
// path took without those times. The distribution of their sum is known, so that the frame's own
// probability is a formula; the run's is the mean over its frames (conditional Monte Carlo;
// Asmussen & Glynn, Stochastic Simulation, 2007, V.4). This takes the drawn times to be independent
// of the rest of the frame, which it tests. What a late frame does to the next ones is part of
// their rest, as often as the run has it.
class LateProbability : public FrameObserver {
 public:
  // `budget` is the largest latency allowed.
  LateProbability(const host::Host& host, Picoseconds budget);

  // True where a time is drawn: else there is nothing to be found.
  static bool applies(const host::Host& host);

  void closed(const Frame& frame, const CriticalPath& path) override;

  struct Result {
    // The probability, in the mean over the frames, with the bounds of the grid's cells.
    statistics::SumOfTimes::Share late;
    // Where a time has a Pareto tail: between these it is with 95 %, as far as the tail's samples
    // tell: models/random/tail_region.h.
    struct Interval {
      double low = 0;
      double high = 1;
    };
    std::optional<Interval> by_tail;
    std::int64_t frames = 0;    // that count
    std::int64_t left_out = 0;  // frames whose solve failed, or with a ninth number of drawn times
    // The rest of a frame hangs on the drawn times, and there is no probability.
    bool dependent = false;
    // Too few pairs of frames were seen to tell: no probability either.
    bool untested = false;
    bool known() const { return !dependent && !untested; }

    void report(config::Figures& f) const;
  };
  // Nothing without frames.
  std::optional<Result> result() const;

 private:
  // The operating system's times: of a release, of a wake-up, of an interrupt.
  static constexpr std::size_t kKinds = 3;
  static constexpr std::array<Phase, kKinds> kPhasesOf = {Phase::release, Phase::wake_up,
                                                          Phase::interrupt};
  using Draws = std::array<std::int32_t, kKinds>;  // how many of each kind a path has

  // Whether one frame's rest is longer than another's where its drawn times are. Frames are taken
  // in pairs, of which the drawn times could as well be exchanged if they were independent: then
  // each product of the sign of their difference and the difference of the rests is as likely as
  // its opposite, whatever the distributions and however the rest changes along the run. What the
  // frame before left to do is no part of it: such frames are in no pair, and the two of one are
  // kLag apart, so that neither makes the other late.
  struct Pairs {
    static constexpr std::int64_t kLag = 8;
    struct First {
      std::int64_t frame = -1;
      double rest = 0;
      double drawn = 0;
    };
    std::array<First, kLag> first;
    std::int64_t count = 0;  // of pairs with different drawn times
    double aligned = 0;      // Σ sign(drawn)·rest, of the differences
    double squares = 0;      // Σ rest²
    double drawn = 0;        // Σ |drawn|

    void add(std::int64_t frame, double rest_ps, double drawn_ps);
    bool dependent() const;
  };
  // The frames whose paths have equal numbers of drawn times.
  struct Combination {
    Draws draws{};
    std::vector<std::int64_t> cells;  // frames by the rest of their path
    std::vector<double> places;       // the sum of their places within the cell, each 0 to 1
    std::int64_t beyond = 0;          // the rest alone is late
    std::int64_t frames = 0;
    Pairs pairs;
  };
  Combination* of(const Draws& draws);
  using Survivals = std::array<std::optional<random::Survival>, kKinds>;
  // Summed over the frames.
  statistics::SumOfTimes::Share late_with(const Survivals& survivals) const;
  std::optional<Result::Interval> by_tail(double late, double frames) const;

  Picoseconds budget_;
  Picoseconds cell_;
  Survivals survivals_;
  std::array<std::optional<random::TimeDistribution>, kKinds> tailed_;  // with a Pareto tail
  std::vector<Combination> combinations_;
  std::size_t used_ = 0;
  std::int64_t left_out_ = 0;
  std::int64_t as_run_ = 0;  // frames that are counted as late or not
  std::int64_t late_as_run_ = 0;
};

}  // namespace hvp::vp
