#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/scene/scene.h"

namespace hvp::app {

// Builds the scenario's scene with further overrides. Throws InputError if they contradict each
// other.
using VariedScene = std::function<std::unique_ptr<Scene>(const std::vector<std::string>&)>;

// The cost of a run in wall-clock seconds per simulated second. Result files are included, pictures
// are not.
struct WallCost {
  double run_s = 0;    // median
  double build_s = 0;  // meshing and assembly, once
};

// The cost of an effect on this machine.
struct EffectCost {
  std::string path;
  bool present = false;  // if so, the scenario is run without the effect, otherwise with it
  std::string setting;   // the override that does that: "dynamics=false"
  // Other overrides that the effect needs and the scenario lacks. They apply to the runs with and
  // without the effect.
  std::vector<std::string> along;
  std::vector<std::string> also;  // other effects that come or go with this one
  std::string refused;            // why the effect could not be tried; empty: it was tried
  WallCost cost;                  // of the scenario under that setting
  // The difference between runs with and without the effect, from pairs of consecutive runs: the
  // median, and half the distance between the least and the largest.
  double difference_s = 0;
  double spread_s = 0;
};

struct EffectCosts {
  int frames = 0;  // of each run
  int runs = 0;    // of each setting
  WallCost scenario;
  std::vector<EffectCost> effects;  // in the order of declaration
};

// Times runs of the scenario as it is, and with each effect removed or added with its defaults.
// Each run is a process of its own. Returns nothing after a signal (results/part_files.h).
std::optional<EffectCosts> measure_effects(const VariedScene& varied, const Progress& progress);

}  // namespace hvp::app
