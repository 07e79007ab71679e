#include "app/linux/guest_results.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/results/driver_findings.h"
#include "app/results/faults.h"
#include "app/results/figures.h"
#include "app/results/part_files.h"
#include "app/results/results_folder.h"

namespace hvp::guest {

namespace {

// The longest time that the board needs to finish after its host has gone.
constexpr vp::Picoseconds kLongestRest = 1'000'000'000'000;

void let_finish(vp::BoardFunction& board) {
  const vp::Picoseconds latest = vp::now_ps() + kLongestRest;
  while ((!board.host().idle() || board.ledger().holds()) && vp::now_ps() < latest) {
    const std::optional<vp::Picoseconds> next = vp::BoardSide::next_event();
    if (!next) break;
    board.host().run_until(std::min(*next, latest));
  }
}

results::TraceSettings traced(const app::Scenario& s, const vp::Verdict& verdict) {
  return {s.output.trace_frames, std::llround(s.output.trace_bytes), verdict.budget()};
}

vp::BusUse all_use(const vp::BusAssembly& buses) {
  vp::BusUse all;
  for (const vp::BusUse& use : buses.pcie() ? buses.pcie()->uses() : buses.pci().uses()) {
    all.busy += use.busy;
    all.bytes += use.bytes;
    all.transactions += use.transactions;
  }
  return all;
}

}  // namespace

bool GuestFigures::driver_is_wrong() const {
  const bool by_rules = guest.driver && !guest.driver->findings.empty();
  const bool unordered = guest.memory_order && guest.memory_order->unordered > 0;
  return by_rules || unordered || (guest.dma && guest.dma->refused + guest.dma->misuses > 0);
}

bool GuestFigures::held() const {
  if (driver_is_wrong() || !guest.complaints.empty()) return false;
  return verdict.frames() == 0 || (verdict.force_in_time() && verdict.load_held());
}

std::string_view GuestFigures::verdict_word() const {
  if (driver_is_wrong()) return "the driver is wrong";
  if (!guest.complaints.empty()) return "the kernel complains";
  if (verdict.frames() == 0) return "no job was solved";
  if (!held()) return "not held";
  const bool faulty =
      std::ranges::any_of(faults, [](const vp::FaultRecord& r) { return r.injected > 0; });
  return faulty ? "held, with faults" : "held; the guest's own work not counted";
}

void GuestFigures::report(config::Figures& f) const {
  f.text("title", title, "the scenario's own line");
  f.truth("held", held(), "no frame was late, and no check (`--check`) found anything");
  f.text("verdict", verdict_word(), "what that is called");
  f.table("deadline", "The latency of a frame: from its birth until its job's last access.", [&] {
    verdict.report_deadline(f);
    f.truth("held", verdict.force_in_time(), "there are no misses");
    verdict.report_lateness(f);
  });
  f.table("latency", "Of all frames.", latency);
  f.table("jitter", "What moves the latency from frame to frame.",
          [&] { latency.report_jitter(f); });
  f.table("load", "From a frame's birth until its job's last access.",
          [&] { verdict.report_load(f); });
  verdict.report_attribution(f);
  results::report_faults(f, faults, verdict.frames(), false);
  if (guest.driver) results::report_driver_findings(f, *guest.driver);
  f.table("board", "What the board counted.", [&] {
    f.count("illegal_accesses", illegal_accesses, "that its registers refused");
    f.count("saturations", saturations, "words that reached their limit");
    f.count("wraps", wraps, "words that lost their high bits");
    f.count("breakdowns", breakdowns, "solves that a direction without curvature ended");
  });
  f.table("bus", "Of the bus that the board is on, set-up, which loads K, included.", [&] {
    f.count("transactions", bus.transactions, "of all that use it");
    f.count("bytes", bus.bytes, "of their data");
    f.time("busy_us", bus.busy, "how long one of them had it, or its direction of a link");
  });
  f.table("guest", "What the kernel did.", [&] {
    f.count("reads", guest.accesses.reads, "of the board's BAR, a block as one");
    f.count("writes", guest.accesses.writes, "likewise");
    f.count("polled_reads", guest.accesses.polled,
            "reads whose end it saw up to a microsecond later, because a timer of its own was due");
    f.count("interrupts", guest.accesses.interrupts, "that it was told of");
    f.text("not_counted", fmt::format("{}", fmt::join(guest.not_counted, ", ")),
           "what the frames' times are without");
    f.truth("lost_writes", guest.accesses.overrun, "its kernel may have lost writes");
    f.value("first_access_us",
            guest.first_access ? config::FigureValue(static_cast<double>(*guest.first_access) / 1e6)
                               : config::FigureValue(),
            config::kMicroseconds, "from power-up; null where it made none");
  });
  f.table_if_present("dma", "With `--check dma`: what the board and its driver did with memory.",
                     guest.dma);
  f.table_if_present("memory_order",
                     "With `guest.memory_order = \"weak\"`: the order of the guest's stores.",
                     guest.memory_order);
  f.when(!guest.checks.empty(), [&] {
    f.table("checks", "What the kernel looked for (`--check`).", [&] {
      f.text("asked", fmt::format("{}", fmt::join(guest.checks, ",")), "the words of `--check`");
      std::int64_t count = 0;
      for (const Complaints::Complaint& complaint : guest.complaints) count += complaint.count;
      f.count("complaints", count, "of all kinds");
      f.list("found", "One entry for each complaint.", guest.complaints,
             [&](const Complaints::Complaint& complaint) {
               f.text("check", complaint.check,
                      "whose it is; `kernel` where it is of none of them");
               f.text("text", complaint.text, "the kernel's line");
               f.count("count", complaint.count, "how often it came");
             });
    });
  });
  f.time("set_up_us", set_up, "from power-up until the first frame is born");
  f.time("simulated_us", simulated, "from power-up until the kernel ended");
}

GuestResults::GuestResults(const std::filesystem::path& folder, const app::Scenario& scenario,
                           const std::filesystem::path& device_file, vp::BoardFunction& board)
    : folder_(folder),
      board_(board),
      verdict_(to_picoseconds(scenario.budget.period_s), to_picoseconds(scenario.budget.period_s)),
      frames_(folder / "frames.csv", verdict_.budget(), results::Columns::times),
      trace_(folder / "trace.json", board.session(), traced(scenario, verdict_)) {
  results::write_resolved_scenario(folder, scenario, device_file);
  vp::Ledger& ledger = board_.ledger();
  ledger.add_observer(verdict_);
  ledger.add_observer(latency_);
  ledger.add_observer(frames_);
  ledger.add_observer(trace_);
  if (scenario.output.trace_frames > 0) ledger.add_tenure_sink(trace_);
}

GuestFigures GuestResults::finish(const app::Scenario& scenario, const GuestFacts& guest) {
  const vp::Picoseconds end = vp::now_ps();
  if (guest.interrupted) board_.host().frames().stop();
  let_finish(board_);
  board_.host().frames().finish(!guest.interrupted);
  frames_.finish();
  trace_.finish();
  const vp::Accelerator& accelerator = board_.accelerator();
  GuestFigures figures{.title = scenario.title,
                       .verdict = verdict_,
                       .latency = results::latency_figures(verdict_, latency_, host::Host{}),
                       .faults = {},
                       .guest = guest,
                       .set_up = board_.session().begin,
                       .simulated = end,
                       .illegal_accesses = accelerator.illegal_accesses(),
                       .saturations = accelerator.saturations(),
                       .wraps = accelerator.wraps(),
                       .breakdowns = accelerator.breakdowns(),
                       .bus = all_use(board_.side().buses())};
  if (const vp::FaultPlan* faults = board_.side().board()->faults()) {
    figures.faults.assign(faults->records().begin(), faults->records().end());
  }
  results::write_through_part_file(folder_ / "summary.json",
                                   results::figures_json(figures).dump(2) + "\n");
  return figures;
}

}  // namespace hvp::guest
