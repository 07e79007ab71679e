#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/linux/board_device.h"
#include "app/results/frames_csv.h"
#include "app/results/latency_figures.h"
#include "app/results/trace.h"
#include "app/scene/scenario.h"
#include "models/config/figures.h"
#include "vp/bus/bus_use.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/latency_statistics.h"
#include "vp/frame/verdict.h"
#include "vp/function/board_function.h"

namespace hvp::guest {

// What the guest leaves behind for the results.
struct GuestFacts {
  BoardDevice::Counts accesses;
  // Simulated time when its kernel first asked for the board; none: it never did.
  std::optional<vp::Picoseconds> first_access;
  // Keys and other words: what the frames' times are without.
  std::vector<std::string> not_counted;
};

// The figures of a run whose host is a Linux kernel, as far as `hvp run` has them: those of times,
// of the board and of its bus. What a scenario's host computes, forces and errors among it, is the
// guest's own here.
struct GuestFigures {
  std::string title;
  vp::Verdict verdict{0, 0};
  results::LatencyFigures latency;
  std::vector<vp::FaultRecord> faults;
  GuestFacts guest;
  vp::Picoseconds set_up = 0;     // from power-up until the first frame is born
  vp::Picoseconds simulated = 0;  // from power-up
  std::int64_t illegal_accesses = 0;
  std::int64_t saturations = 0;
  std::int64_t wraps = 0;
  std::int64_t breakdowns = 0;
  vp::BusUse bus;  // of all that use it

  // Deadline and load of every frame, where there were some.
  bool held() const;
  // What that is called; never a PASS, as forces and the guest's own work are in no figure.
  std::string_view verdict_word() const;
  // All of summary.json.
  void report(config::Figures& f) const;
};

// The result files of such a run: frames.csv without forces, trace.json, summary.json,
// scenario.resolved.toml.
class GuestResults {
 public:
  // The folder is there, without what an earlier run left in it. Keeps a reference to the board.
  GuestResults(const std::filesystem::path& folder, const app::Scenario& scenario,
               const std::filesystem::path& device_file, vp::BoardFunction& board);

  // After the run: writes the files.
  GuestFigures finish(const app::Scenario& scenario, const GuestFacts& guest);

 private:
  std::filesystem::path folder_;
  vp::BoardFunction& board_;
  vp::Verdict verdict_;
  vp::LatencyStatistics latency_;
  results::FramesCsv frames_;
  results::Trace trace_;
};

}  // namespace hvp::guest
