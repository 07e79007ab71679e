#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/linux/board_device.h"
#include "app/linux/complaints.h"
#include "app/linux/dma_check.h"
#include "app/results/frames_csv.h"
#include "app/results/latency.h"
#include "app/results/trace.h"
#include "app/scene/scenario.h"
#include "models/config/figures.h"
#include "vp/bus/bus_meter.h"
#include "vp/fault/fault_plan.h"
#include "vp/fpga/master_access.h"
#include "vp/frame/latency_statistics.h"
#include "vp/frame/verdict.h"
#include "vp/function/driver_finding.h"
#include "vp/function/outside_host.h"

namespace hvp::guest {

// What the guest itself contributes to the results.
struct GuestFacts {
  BoardDevice::Counts accesses;
  std::optional<DmaCheck::Counts> dma;                 // none: not checked
  std::optional<vp::WeakMemory::Counts> memory_order;  // none: its stores are in order
  // The simulated time at which the kernel first accessed the board; none: it never did.
  std::optional<vp::Picoseconds> first_access;
  // The keys and other items whose time the frames' times do not contain.
  std::vector<std::string> not_counted;
  // The words of --check, and what the kernel complained of.
  std::vector<std::string> checks;
  std::vector<Complaints::Complaint> complaints;
  // The user ended the run: a job under way is none, where it is one that failed otherwise.
  bool interrupted = false;
  // None: nobody watched.
  std::optional<vp::DriverReport> driver;
};

// The figures of a run whose host is a Linux kernel: those of `hvp run` about times, the board and
// its bus. Forces and errors are missing, as the guest computes them.
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
  vp::BusUse bus;  // of all users

  // True if every frame met its deadline and the load, and no check found anything.
  bool held() const;
  bool driver_is_wrong() const;
  // The verdict in words. It is never PASS, as no figure covers forces and the guest's own work.
  std::string_view verdict_word() const;
  // Reports the content of summary.json.
  void report(config::Figures& f) const;
};

// Writes the result files of such a run: frames.csv without forces, trace.json, summary.json and
// scenario.resolved.toml.
class GuestResults {
 public:
  // The folder exists and has no earlier results. Keeps a reference to the board.
  GuestResults(const std::filesystem::path& folder, const app::Scenario& scenario,
               const std::filesystem::path& device_file, vp::BoardFunction& board);

  // Who draws the board's own transactions, for a run that asks for them.
  vp::MasterObserver& lanes() { return trace_; }

  // Writes the files after the run and returns the figures.
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
