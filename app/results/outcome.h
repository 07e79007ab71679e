#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "app/results/bus_load.h"
#include "app/results/contact_figures.h"
#include "app/results/latency_figures.h"
#include "app/results/quality.h"
#include "app/results/scene_figures.h"
#include "app/results/stiffness_budget.h"
#include "app/results/tried_remedy.h"
#include "models/config/figures.h"
#include "models/host/rounding_estimate.h"
#include "models/plant/loop_quality.h"
#include "models/stability/flag.h"
#include "models/stability/force_quality.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/verdict.h"
#include "vp/host/servo_process.h"

namespace hvp::results {

// What a run came to: everything that the terminal and summary.json show, each of it as its source
// keeps it.
struct Outcome {
  SceneFigures scene;
  vp::Verdict verdict{0, 0};
  LatencyFigures latency;
  std::int64_t ticks = 0;  // frames and skipped ones; fewer than were asked for: interrupted
  vp::Picoseconds set_up = 0;
  vp::Picoseconds simulated = 0;  // from the first tick to the end of the last frame

  vp::ServoCounts servo;
  std::vector<vp::FaultRecord> faults;  // [[fault]], one for each item
  std::optional<AcceleratorFigures> accelerator;
  BusFigures bus;
  ContactFigures contact;

  std::optional<Accuracy> accuracy;
  std::vector<ErrorBudget> error_budgets;
  // Of the matrix' words, at set-up.
  std::optional<host::RoundingEstimate> rounding;
  std::optional<RefinementFigures> refinement;
  // Where numbers were computed.
  std::optional<stability::ForceQuality> force;  // of the first probe
  std::vector<stability::ForceQuality> forces;   // of each, where there are several
  std::optional<Strain> strain;
  // Of each device with mass, and what it could stand before a wall.
  std::vector<plant::LoopQuality> loop;
  std::optional<StiffnessBudget> stiffness;
  stability::Flags flags;
  // Of the board's words.
  std::int64_t saturations = 0;
  std::int64_t wraps = 0;
  std::int64_t breakdowns = 0;
  // What would take the flags away, where that was looked for.
  std::optional<TriedRemedy> remedy;
  double remedy_search_s = 0;  // of wall-clock time; in no result file but performance.json
  // The first frame that output.trace_size left out of trace.json.
  std::optional<std::int64_t> trace_cut_at;

  // Whether every budget held that the scenario states.
  bool held() const;
  bool partial() const { return ticks < scene.frames; }
  // A force that is held from an earlier frame is not this frame's force.
  bool force_in_time() const { return verdict.force_in_time() && servo.driver_errors == 0; }
  // Whether frames in contact were compared, and enough of them to say something.
  bool accuracy_measured() const;
  // Whether anything was injected, or the driver had trouble of any kind.
  bool faults_happened() const;
  // What a budget that held is called. "PASS" alone is said of a run in which everything that the
  // word covers was measured: without flags and faults, with numbers, with a contact, and beside a
  // reference.
  std::string_view verdict_word() const;

  // All of summary.json.
  void report(config::Figures& f) const;

 private:
  void report_times(config::Figures& f) const;
  void report_numbers(config::Figures& f) const;
  void report_stability(config::Figures& f) const;
  void report_parts(config::Figures& f) const;
};

}  // namespace hvp::results
