#include "app/explain/effect_costs.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "app/process/child_process.h"
#include "app/process/temporary_folder.h"
#include "app/results/part_files.h"
#include "app/run/run.h"
#include "models/config/effects.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr int kRuns = 3;
constexpr int kFewFrames = 300;
// The least wall-clock time of a run that can be timed well.
constexpr double kLongEnough = 0.25;  // s

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::array<double, kRuns> values) {
  std::ranges::sort(values);
  return values[kRuns / 2];
}

struct Timed {
  double wall_s = 0;
  double simulated_s = 0;

  double rate() const { return simulated_s > 0 ? wall_s / simulated_s : 0; }
};

Timed timed_run(Scene& scene, const std::filesystem::path& folder) {
  const json answer = json::parse(in_child([&] {
    const Clock::time_point start = Clock::now();
    RunOptions options;
    options.directory = folder;
    const results::Outcome outcome = run(scene, options);
    return json{seconds_since(start), to_seconds(outcome.simulated)}.dump();
  }));
  return {answer[0].get<double>(), answer[1].get<double>()};
}

struct Built {
  std::unique_ptr<Scene> scene;
  double build_s = 0;
};

Built build(const VariedScene& varied, const std::vector<std::string>& overrides) {
  const Clock::time_point start = Clock::now();
  Built built;
  built.scene = varied(overrides);
  built.build_s = seconds_since(start);
  return built;
}

config::EffectSurvey survey_of(const Scene& scene) {
  return config::survey_effects(scene.scenario());
}

// The number of frames to time: few, or more if these take too little time, or all if the scenario
// needs them, as with a fault in a later frame.
int frames_to_time(const VariedScene& varied, const std::filesystem::path& folder) {
  const int all = build(varied, {}).scene->scenario().frames;
  const int few = std::min(all, kFewFrames);
  Built built;
  try {
    built = build(varied, {fmt::format("frames={}", few)});
  } catch (const InputError&) {
    return all;
  }
  const double wall_s = timed_run(*built.scene, folder).wall_s;
  const double wanted = few * std::max(1.0, kLongEnough / std::max(wall_s, 1e-4));
  return static_cast<int>(std::min<double>(all, wanted));
}

class Measurement {
 public:
  Measurement(const VariedScene& varied, const Progress& progress)
      : varied_(varied), progress_(progress) {}

  std::optional<EffectCosts> measure() {
    const results::DeferredInterruption deferred;
    try {
      tell("timing the scenario");
      EffectCosts costs;
      costs.frames = frames_to_time(varied_, folder_.path());
      costs.runs = kRuns;
      frames_ = fmt::format("frames={}", costs.frames);
      base_ = build(varied_, {frames_});
      std::array<double, kRuns> rates{};
      for (double& rate : rates) rate = timed_run(*base_.scene, folder_.path()).rate();
      costs.scenario = {median(rates), base_.build_s};
      const config::EffectSurvey survey = survey_of(*base_.scene);
      const std::vector<config::Effect>& effects = survey.effects();
      for (std::size_t i = 0; i < effects.size(); ++i) {
        tell(fmt::format("timing {} ({} of {})", effects[i].path, i + 1, effects.size()));
        costs.effects.push_back(cost_of(effects[i], survey));
        if (results::interrupted() != 0) return std::nullopt;
      }
      return costs;
    } catch (const std::exception&) {
      // After a signal the failure of the stopped run is not reported.
      if (results::interrupted() != 0) return std::nullopt;
      throw;
    }
  }

 private:
  void tell(const std::string& what) const {
    if (progress_) progress_(what);
  }

  // Lists the other effects that changed. Throws if the effect itself did not change.
  static std::vector<std::string> changed_with(const std::string& path,
                                               const std::vector<config::Effect>& before,
                                               const std::vector<config::Effect>& after) {
    std::vector<std::string> also;
    bool changed = false;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (before[i].present == after[i].present) continue;
      if (before[i].path == path) {
        changed = true;
      } else {
        also.push_back(before[i].path);
      }
    }
    if (!changed) throw InputError("another key decides whether it is there");
    return also;
  }

  EffectCost cost_of(const config::Effect& effect, const config::EffectSurvey& survey) {
    EffectCost cost;
    cost.path = effect.path;
    cost.present = effect.present;
    cost.setting = effect.path + (effect.present ? "=false" : "=true");
    if (!effect.present) cost.along = survey.to_bring(effect);
    try_setting(cost);
    if (!cost.refused.empty() && !effect.belongs_to.empty()) {
      // An effect that the value of another key implies has no setting of its own.
      EffectCost implied = cost;
      std::erase(implied.along, effect.belongs_to);
      implied.setting = effect.belongs_to;
      try_setting(implied);
      if (implied.refused.empty()) return implied;
    }
    if (effect.present && !cost.refused.empty()) {
      // An effect that is a list is removed by an empty list.
      EffectCost emptied = cost;
      emptied.setting = effect.path + "=[]";
      try_setting(emptied);
      if (emptied.refused.empty()) return emptied;
    }
    return cost;
  }

  void try_setting(EffectCost& cost) {
    cost.refused.clear();
    try {
      std::vector<std::string> settings = {frames_};
      settings.insert(settings.end(), cost.along.begin(), cost.along.end());
      Built own;
      if (!cost.along.empty()) own = build(varied_, settings);
      Scene& without = cost.along.empty() ? *base_.scene : *own.scene;
      settings.push_back(cost.setting);
      const Built built = build(varied_, settings);
      cost.also =
          changed_with(cost.path, survey_of(without).effects(), survey_of(*built.scene).effects());
      time_pairs(without, *built.scene, cost);
      cost.cost.build_s = built.build_s;
    } catch (const std::exception& e) {
      cost.refused = e.what();
    }
  }

  // The runs of a pair follow each other, so that other load on the machine affects both.
  void time_pairs(Scene& before_it, Scene& scene, EffectCost& cost) {
    std::array<double, kRuns> rates{};
    std::array<double, kRuns> differences{};
    for (std::size_t i = 0; i < kRuns; ++i) {
      const double before = timed_run(before_it, folder_.path()).rate();
      rates[i] = timed_run(scene, folder_.path()).rate();
      differences[i] = cost.present ? before - rates[i] : rates[i] - before;
    }
    cost.cost.run_s = median(rates);
    cost.difference_s = median(differences);
    const auto [least, most] = std::ranges::minmax(differences);
    cost.spread_s = 0.5 * (most - least);
  }

  const VariedScene& varied_;
  const Progress& progress_;
  TemporaryFolder folder_;  // of the runs' result files, which nobody reads
  std::string frames_;
  Built base_;
};

}  // namespace

std::optional<EffectCosts> measure_effects(const VariedScene& varied, const Progress& progress) {
  return Measurement(varied, progress).measure();
}

}  // namespace hvp::app
