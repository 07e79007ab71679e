#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/results/engine_clocks.h"
#include "app/results/latency_figures.h"
#include "app/results/tried_remedy.h"
#include "models/fem/linearity.h"
#include "models/host/deviation.h"
#include "models/host/rounding_estimate.h"
#include "models/stability/flag.h"
#include "models/stability/force_quality.h"
#include "vp/bus_use.h"
#include "vp/fault/fault_plan.h"
#include "vp/host/servo_process.h"
#include "vp/verdict.h"

namespace hvp::results {

// How far the run was from double precision; absent where nothing was compared. "Rounded" is the
// matrix as the board's words have it, everything else the true model.
struct Accuracy {
  struct Quantity {
    // Of the run's largest: the mean over all frames, and the worst one.
    std::optional<double> mean;
    std::optional<double> worst;
    std::int64_t worst_frame = -1;
    std::optional<double> mean_rounded;
    // Of the frame's own size, in contact.
    std::optional<host::Deviation::OfFrame> of_frame;
    std::optional<host::Deviation::OfFrame> of_frame_rounded;
  };
  Quantity displacement;
  Quantity force;
  std::int64_t frames = 0;      // compared, the body at rest not counted
  std::int64_t in_contact = 0;  // frames in contact, compared or not
};

// How much of the servo loop's time the bus was taken.
struct BusLoad {
  double share = 0;
  double worst_share = 0;  // from one frame's solution to the next one's
  vp::Picoseconds time = 0;
  vp::BusUses uses;  // of every initiator

  double share_of(const vp::BusUse& use) const {
    return time > 0 ? static_cast<double>(use.busy) / static_cast<double>(time) : 0;
  }
};

// What a run came to: everything that the terminal and summary.json show.
struct Outcome {
  // Whether every budget held that the scenario states.
  bool held() const;

  vp::Picoseconds period = 0;
  vp::Picoseconds budget = 0;
  vp::Picoseconds set_up = 0;
  vp::Picoseconds worst = 0;
  vp::Picoseconds p50 = 0;
  vp::Picoseconds p99 = 0;
  vp::Picoseconds worst_load = 0;
  std::int64_t worst_frame = 0;
  std::int64_t frames = 0;
  std::int64_t frames_asked = 0;
  std::int64_t ticks = 0;  // frames and skipped ones; fewer than were asked for: interrupted
  std::int64_t skipped_ticks = 0;
  std::int64_t late = 0;
  std::int64_t misses = 0;  // late, skipped, or without a solution
  std::int64_t overloads = 0;
  bool force_in_time = false;
  bool load_held = false;
  std::vector<vp::Attribution> attribution;
  LatencyFigures latency;
  std::optional<Spread> lateness;  // of late forces, where there are some
  std::vector<statistics::Histogram::Octave> late_octaves;
  std::optional<Spread> release;  // with [host.jitter]
  std::optional<Spread> wake_up;  // with [host.wake_up]

  std::int64_t bus_transactions = 0;
  std::int64_t bus_bytes = 0;
  vp::Picoseconds bus_busy = 0;
  BusLoad bus_load;
  // With [bus.pcie]; the initiators are in both, with the direction of their data.
  struct LinkLoad {
    BusLoad to_board;
    BusLoad to_host;
  };
  std::optional<LinkLoad> link_load;
  vp::Picoseconds simulated = 0;  // from the first tick to the end of the last frame
  std::int64_t illegal_accesses = 0;
  std::optional<EngineClocks> engine;  // where the fidelity has one and it solved something
  std::int64_t driver_errors = 0;
  std::string last_driver_error;
  vp::ServoCounts troubles;             // what the driver returned, and what the loop did then
  std::vector<vp::FaultRecord> faults;  // [[fault]], one for each item
  std::int64_t contact_changes = 0;
  std::int64_t collision_passes = 0;
  vp::Picoseconds longest_pass = 0;

  // The first frame that output.trace_size left out of trace.json.
  std::optional<std::int64_t> trace_cut_at;

  std::optional<Accuracy> accuracy;
  // A budget of accuracy that the scenario states.
  struct ErrorBudget {
    std::string_view of;  // "displacement", "force"
    double limit = 0;
    double p95 = 0;    // of the frames in contact, of their own size
    double worst = 0;  // of all frames, of the run's largest
    bool measured = false;

    bool held() const { return measured && p95 <= limit && worst <= limit; }
  };
  std::vector<ErrorBudget> error_budgets;
  // Of the matrix' words, at set-up.
  std::optional<host::RoundingEstimate> rounding;
  // Where numbers were computed.
  std::optional<stability::ForceQuality> force;
  struct Strain {
    fem::Strains worst;
    std::int64_t frame = -1;
  };
  std::optional<Strain> strain;
  // Where the probe has not touched the body.
  struct Approach {
    double distance = 0;  // m, of the tip from the surface
    std::int64_t frame = 0;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  };
  std::optional<Approach> approach;
  // The deepest place in the body without contact, where that is a flag.
  std::optional<Approach> missed_contact;
  stability::Flags flags;
  // What would take the flags away, where that was looked for.
  std::optional<TriedRemedy> remedy;
  double remedy_search_s = 0;  // of wall-clock time; in no result file but performance.json
  std::int64_t saturations = 0;
  std::int64_t wraps = 0;
  std::int64_t breakdowns = 0;
  std::int64_t clamped_words = 0;   // of right-hand sides
  std::int64_t clamped_forces = 0;  // frames whose force did not fit the device's register

  bool partial() const { return ticks < frames_asked; }
  // Whether frames in contact were compared, and enough of them to say something.
  bool accuracy_measured() const;
};

}  // namespace hvp::results
