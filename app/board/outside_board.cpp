#include "app/board/outside_board.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/board/stop_points.h"
#include "app/results/driver_findings.h"
#include "models/config/input_error.h"
#include "models/time/picoseconds.h"

namespace hvp::app {

namespace {

// Warns of settings of the scenario's own host that the other program decides itself.
void warn_of_the_hosts_way(const Scenario& s) {
  using Method = vp::Transfer::Method;
  const bool words =
      s.transfer.method == Method::programmed_io || s.transfer.method == Method::write_combined_io;
  if (words && !s.bus.pcie) {
    spdlog::warn(
        "transfer.method: how b and U are moved is the other program's to say; a block is a burst "
        "here");
  }
}

}  // namespace

vp::PlatformSettings outside_board(const LoadedScenario& loaded) try {
  require_board_with_words(loaded.scenario);
  Scenario s = loaded.scenario;
  if (s.bus.graphics_traffic) {
    throw InputError("bus.graphics_traffic",
                     "pictures are drawn by the host of hvp run, and this one is another program: "
                     "expected a scenario without them");
  }
  warn_of_the_hosts_way(s);
  take_samples(s);
  vp::PlatformSettings settings(s);
  settings.period = to_picoseconds(s.budget.period_s);
  settings.budget = settings.period;
  settings.solver = s.solver;
  if (s.guest && s.guest->schedule == host::GuestCosts::Schedule::random) {
    settings.longest_stall_s = s.guest->longest_delay_s;
  }
  return settings;
} catch (const InputError& e) {
  throw loaded.document.complete(e);
}

void require_strong_order(const LoadedScenario& loaded, std::string_view who) try {
  const Scenario& s = loaded.scenario;
  if (!s.guest || s.guest->memory_order != host::GuestCosts::MemoryOrder::weak) return;
  throw InputError("guest.memory_order",
                   fmt::format("{} tells of no barriers: expected \"strong\"", who));
} catch (const InputError& e) {
  throw loaded.document.complete(e);
}

void warn_of_faults_that_never_struck(vp::BoardFunction& board) {
  const vp::FaultPlan* const plan = board.side().board()->faults();
  if (plan == nullptr) return;
  for (const vp::FaultRecord& record : plan->records()) {
    if (record.missing() == 0) continue;
    if (record.injected > 0) {
      spdlog::warn("[[fault]] {} happened in {} of {} jobs", vp::name(record.fault.kind),
                   record.injected, record.fault.count);
      continue;
    }
    spdlog::warn("[[fault]] {} did not happen: {}", vp::name(record.fault.kind),
                 record.why_not(board.host().frames().jobs()));
  }
}

void require_stops(const std::vector<std::string>& points) try {
  for (const std::string& point : points) StopPoints::require_words(point);
} catch (const InputError& e) {
  throw InputError(fmt::format("--stop-at {}", e.what()));
}

void warn_of_a_stop_that_never_came(const std::string& never) {
  if (!never.empty()) spdlog::warn("--stop-at {}: it never came", never);
}

void watch_driver(vp::DriverRules& rules, vp::BoardFunction& board) {
  rules.report_to([](const vp::DriverFinding& finding) {
    spdlog::warn("driver: {}", results::finding_text(finding));
  });
  rules.watch(board);
}

}  // namespace hvp::app
