#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/results/contact.h"
#include "app/results/flags.h"
#include "app/results/host_solve.h"
#include "app/results/latency.h"
#include "app/results/loop.h"
#include "app/results/quality.h"
#include "app/results/scene_figures.h"
#include "models/config/figures.h"
#include "models/host/rounding_estimate.h"
#include "models/plant/loop_quality.h"
#include "models/stability/flag.h"
#include "models/stability/force_quality.h"
#include "vp/bus/bus_meter.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/late_probability.h"
#include "vp/frame/servo_counts.h"
#include "vp/frame/verdict.h"

namespace hvp::results {

// The share of the servo loop's time in which a bus was occupied.
struct BusLoad {
  double share = 0;
  double worst_share = 0;  // the largest from one frame's solution to the next one's
  vp::Picoseconds time = 0;
  vp::BusUses uses;  // one an initiator

  double share_of(const vp::BusUse& use) const {
    return time > 0 ? static_cast<double>(use.busy) / static_cast<double>(time) : 0;
  }
};

// The buses' figures of a run: the table `bus`.
struct BusFigures {
  std::int64_t transactions = 0;
  std::int64_t bytes = 0;
  vp::Picoseconds busy = 0;
  BusLoad load;
  // With [bus.pcie]. Every initiator is in both, with the direction of its data.
  struct Link {
    BusLoad to_board;
    BusLoad to_host;
  };
  std::optional<Link> link;

  void report(config::Figures& f) const;
};

// The outcome of a run: everything that the terminal and summary.json show, each part in the form
// in which its source keeps it.
struct Outcome {
  SceneFigures scene;
  vp::Verdict verdict{0, 0};
  // Where the operating system's times are drawn, in enough frames.
  std::optional<vp::LateProbability::Result> late_probability;
  LatencyFigures latency;
  std::int64_t ticks = 0;  // frames and skipped ticks; fewer than were asked for: interrupted
  vp::Picoseconds set_up = 0;
  vp::Picoseconds simulated = 0;  // from the first tick to the end of the last frame

  vp::ServoCounts servo;
  std::vector<vp::FaultRecord> faults;  // one for each item of [[fault]]
  std::optional<AcceleratorFigures> accelerator;
  BusFigures bus;
  ContactFigures contact;

  std::optional<Accuracy> accuracy;
  std::vector<ErrorBudget> error_budgets;
  // The effect of the matrix' words, found at set-up.
  std::optional<host::RoundingEstimate> rounding;
  std::optional<RefinementFigures> refinement;
  std::optional<MatrixFigures> matrix;  // where it is renewed
  std::optional<ExplicitFigures> explicit_steps;
  std::optional<HostSolveFigures> host_solve;
  // Present where numbers were computed.
  std::optional<stability::ForceQuality> force;  // of the first probe
  std::vector<stability::ForceQuality> forces;   // one a probe, where there are several
  std::optional<Strain> strain;
  // One for each device where any has mass, empty of one without, and the stiffness that the loop
  // is stable with: the least, where devices differ, and that of each.
  std::vector<plant::LoopQuality> loop;
  std::optional<StiffnessBudget> stiffness;
  std::vector<StiffnessBudget> stiffnesses;
  // One a probe, with their effects.
  std::vector<host::VirtualTool> tools;
  std::vector<host::PassivityController> passivity;

  stability::Flags flags;
  // Counts of the board's words and solves.
  std::int64_t saturations = 0;
  std::int64_t wraps = 0;
  std::int64_t breakdowns = 0;
  // The remedy for the flags, where one was looked for.
  std::optional<TriedRemedy> remedy;
  double remedy_search_s = 0;  // wall-clock time; in no result file but performance.json

  // The first frame that output.trace_size left out of trace.json.
  std::optional<std::int64_t> trace_cut_at;

  // Takes the budgets of the devices, in their order.
  void take_stiffnesses(std::vector<StiffnessBudget> budgets);
  // True if the run meets every budget that the scenario states.
  bool held() const;
  bool partial() const { return ticks < scene.frames; }
  // A held force, which is of an earlier frame, is not this frame's force.
  bool force_in_time() const { return verdict.force_in_time() && servo.driver_errors == 0; }
  // True if enough frames in contact were compared for the accuracy to mean something.
  bool accuracy_measured() const;
  // True if anything was injected, or the driver had trouble of any kind.
  bool faults_happened() const;
  // True if a bit that flipped gave solutions other words, whoever noticed.
  bool solutions_were_wrong() const;
  // The name of the verdict on a run that meets its budgets. "PASS" alone is said of a run in which
  // everything that the word covers was measured: without flags and faults, with numbers, with a
  // contact, and beside a reference.
  std::string_view verdict_word() const;

  // All of summary.json.
  void report(config::Figures& f) const;

 private:
  void report_times(config::Figures& f) const;
  void report_numbers(config::Figures& f) const;
  void report_stability(config::Figures& f) const;
  void report_parts(config::Figures& f) const;
};

// The text of summary.json. SI units unless a name says otherwise; no wall-clock time, no path.
std::string summary_json(const Outcome& outcome);

// performance.json: the figures that differ between two runs of the same scenario.
struct Performance {
  double build_scene_s = 0;
  double simulate_s = 0;
  double remedy_s = 0;
  double frames_per_s = 0;
  double draw_s = 0;
  double simulated_s = 0;
  double peak_memory_mb = 0;

  void report(config::Figures& f) const;
};

}  // namespace hvp::results
