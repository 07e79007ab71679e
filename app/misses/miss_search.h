#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/process/progress.h"
#include "app/scene/scene.h"
#include "models/config/figures.h"

namespace hvp::app {

// How often a force is late, by importance sampling of the platform's own runs (random::Tilt,
// vp::RareMisses): also where a frame's rest depends on the times that are drawn, so that their
// convolution says nothing.
struct MissFigures {
  struct Effect {
    std::string name;        // its table in the scenario
    std::int64_t draws = 0;  // of a frame, at most
  };
  std::vector<Effect> effects;  // that draw
  int runs = 0;
  std::int64_t frames = 0;    // counted
  std::int64_t left_out = 0;  // frames whose solve failed
  std::int64_t seen = 0;      // late frames
  double share = 0;           // of late frames, as the times come
  double low = 0;             // with 95 %, by how much the runs differ
  double high = 0;
  // Too few runs with a late frame for an interval.
  bool uncertain = true;
  // By convolution, of the first run, whose times are drawn as they come; empty: not known, for
  // what reason convolution says.
  std::optional<double> by_convolution;
  enum class Convolution { known, dependent, untested, of_other_times };
  Convolution convolution = Convolution::of_other_times;
  bool plain = false;   // lateness is the norm: the times were drawn as they come
  bool pareto = false;  // a Pareto tail is taken as stated

  void report(config::Figures& f) const;
};

struct MissSettings {
  int most_runs = 400;
  double precision = 0.2;  // of the share: where the interval's half is smaller, no further run
  int runs_in_vain = 100;  // without a late force, after which there is no further run
};

// Throws InputError where nothing is drawn.
MissFigures find_misses(Scene& scene, const MissSettings& wanted, const Progress& progress);

}  // namespace hvp::app
