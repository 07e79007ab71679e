#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/scene/scene.h"

namespace hvp::app {

// The scenario's scene under more overrides. Throws InputError where they do not go together.
using VariedScene = std::function<std::unique_ptr<Scene>(const std::vector<std::string>&)>;

// Of a run: wall-clock seconds for a simulated second, files included and pictures left out.
struct WallCost {
  double run_s = 0;    // the median
  double build_s = 0;  // to mesh and to assemble, once
};

// What an effect costs on this machine.
struct EffectCost {
  std::string path;
  bool present = false;  // in the scenario, which is then run without it; else with it
  std::string setting;   // "dynamics=false": what is laid over the scenario
  // What it needs beside it and the scenario has not: laid over the scenario too, with the effect
  // and in the runs without it.
  std::vector<std::string> along;
  std::vector<std::string> also;  // other effects that come or go with it
  std::string refused;            // why that could not be tried; empty: it was
  WallCost cost;                  // of the scenario under that setting
  // With the effect less without it, in pairs of runs one after the other: the median, and half of
  // what lies between the least and the largest.
  double difference_s = 0;
  double spread_s = 0;
};

struct EffectCosts {
  int frames = 0;  // of each run
  int runs = 0;    // of each setting
  WallCost scenario;
  std::vector<EffectCost> effects;  // in the order of their declaration
};

// Times runs of the scenario as it is and with each effect taken out, or put in with its defaults,
// each run in a process of its own. Nothing where a signal came (interruption.h).
std::optional<EffectCosts> measure_effects(const VariedScene& varied, const Progress& progress);

}  // namespace hvp::app
