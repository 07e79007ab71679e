#include "app/results/faults.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/results/outcome.h"

namespace hvp::results {

namespace {

struct StatusErrors {
  std::string_view status;
  vp::ErrorCount errors;

  void report(config::Figures& f) const {
    f.count("count", errors.count,
            "how often the driver returned it: frames, accesses that were repeated, set-ups that "
            "failed");
    f.count("first_frame", errors.first_frame, "-1 in set-up");
  }
};

std::vector<StatusErrors> errors_of(const vp::ServoCounts& counts) {
  std::vector<StatusErrors> errors;
  for (std::size_t i = 0; i < counts.errors.size(); ++i) {
    if (counts.errors[i].count == 0) continue;
    errors.push_back({hvp_status_name(static_cast<hvp_status>(i)), counts.errors[i]});
  }
  return errors;
}

std::string place_text(const vp::FlipEffect& effect) {
  std::string text = vp::engine::name(effect.flip.place);
  for (const vp::engine::FlipIndex& index : vp::engine::kFlipIndices) {
    if (!has_index(effect.flip.place, index.index)) continue;
    text += fmt::format(" {} {}", index.key, effect.flip.*index.index);
  }
  return text + fmt::format(" at clock {}", effect.clock);
}

}  // namespace

void report_driver(config::Figures& f, const vp::ServoCounts& c) {
  f.tables("errors", "by status; those that never came are left out", errors_of(c),
           [](const StatusErrors& e) { return e.status; });
  f.count("repeated_accesses", c.mended.aborted + c.mended.damaged, "what cost time only");
  f.count("lost_interrupts", c.mended.lost_interrupts, "likewise");
  f.count("lost_acknowledgements", c.mended.lost_acknowledgements, "likewise");
  f.count("held_frames", c.held_frames, "frames whose force is that of an earlier one");
  f.count("longest_hold_ticks", c.longest_hold,
          "ticks in a row without a new force, skipped ones included");
  f.count("recoveries", c.recoveries, "how often the board was set up again");
  f.count("failed_set_ups", c.failed_set_ups, "and in vain");
  f.frame("given_up_frame", c.given_up_at, "where the board was given up, or null");
}

void report_faults(config::Figures& f, const std::vector<vp::FaultRecord>& faults,
                   std::int64_t frames, bool driver_is_known) {
  f.list("faults", "One entry for each `[[fault]]` ([faults.md](faults.md)).", faults,
         [&](const vp::FaultRecord& r) {
           f.text("kind", vp::name(r.fault.kind), "what it is");
           f.count("injected", r.injected, "how often");
           f.when(driver_is_known, [&] { f.count("noticed", r.noticed, "by the driver"); });
           f.count("corrected", r.corrected, "by the bus, at the cost of time");
           f.when(driver_is_known, [&] { f.count("unnoticed", r.unnoticed(), "by nobody"); });
           f.count("first_frame", r.injected > 0 ? std::optional(r.first_frame) : std::nullopt,
                   "in which it was injected, or null");
           f.value("why_not",
                   r.injected == 0 ? config::FigureValue(r.why_not(frames)) : config::FigureValue(),
                   {}, "why it did not happen, or null");
         });
}

Flips::Flips(const std::vector<vp::FaultRecord>& faults) {
  for (const vp::FaultRecord& r : faults) {
    if (r.fault.kind != vp::FaultKind::flip) continue;
    const vp::FlipEffect& e = r.effect;
    if (first.empty() && r.injected > 0) first = place_text(e);
    made += e.flipped;
    noticed += r.noticed;
    wrong += e.wrong;
    told += e.told;
    worst = std::max(worst, e.worst);
    last_wrong_frame = std::max(last_wrong_frame, e.last_wrong_frame);
  }
}

std::optional<Flips> flips_of(const std::vector<vp::FaultRecord>& faults) {
  const bool some = std::ranges::any_of(
      faults, [](const auto& r) { return r.fault.kind == vp::FaultKind::flip; });
  return some ? std::optional<Flips>(faults) : std::nullopt;
}

void Flips::report(config::Figures& f) const {
  f.count("made", made, "bits that flipped");
  f.text("first", first, "the first of them, and behind which clock of its job");
  f.count("noticed", noticed, "by the driver");
  f.count("wrong_solutions", wrong,
          "jobs whose U was not that of an engine without flips, begun with the same U and b");
  f.ratio("worst_error", worst, "the largest error of a word of those over the largest word");
  f.count("told_by_flags", told, "of those jobs the ones with a flag that they would not have had");
  f.frame("last_wrong_frame", last_wrong_frame, "the frame of the last of those, or null");
}

namespace {

using Out = std::back_insert_iterator<std::string>;

std::string times(std::int64_t count) {
  return count == 1 ? std::string("once") : fmt::format("{} times", count);
}

// The remedy for somebody with a real board.
std::string_view remedy(hvp_status status) {
  switch (status) {
    case HVP_ERROR_TIMEOUT:
      return "a host.timeout above the solve's time; where STATUS stays busy, the board's design";
    case HVP_ERROR_BUS:
    case HVP_ERROR_NO_DEVICE:
      return "the board's slot, power and address; host.recovery.attempts and back_off give it "
             "more time to come back";
    case HVP_ERROR_DATA:
      return "the bus' signals: clock, loads and connectors; host.recovery.retries repeats a read";
    case HVP_ERROR_SATURATED:
      return "what the FLAG saturation says; host.recovery.hold_saturated = \"never\" uses such a "
             "force";
    default:
      return "docs/driver.md, table of errors";
  }
}

void flip_text(Out out, const vp::FaultRecord& r) {
  const vp::FlipEffect& e = r.effect;
  fmt::format_to(out, "; the first of {}", place_text(e));
  if (e.flipped < r.injected) {
    fmt::format_to(out, "; {} behind the end of the run", r.injected - e.flipped);
  }
  if (e.wrong == 0) {
    fmt::format_to(out, "; no solution had other words");
    return;
  }
  fmt::format_to(out,
                 "; {} wrong, by {:.3g} of the largest word at most, the last in frame {}; "
                 "flags told of {}",
                 counted(e.wrong, "solution"), e.worst, e.last_wrong_frame, e.told);
  if (e.told == e.wrong) return;
  fmt::format_to(out,
                 "\n    remedy: none on the board, whose driver does not look at words; beside a "
                 "reference, budget.displacement_error fails the run");
}

void fault_lines(Out out, const Outcome& o) {
  if (o.faults.empty()) return;
  for (const vp::FaultRecord& r : o.faults) {
    if (r.injected == 0) {
      fmt::format_to(out, "  {:<16} did not happen: {}\n", vp::name(r.fault.kind),
                     r.why_not(o.verdict.frames()));
      continue;
    }
    fmt::format_to(
        out, "  {:<16} {}{}, first in frame {}", vp::name(r.fault.kind), times(r.injected),
        r.missing() == 0 ? std::string() : fmt::format(" of {}", r.fault.count), r.first_frame);
    if (r.corrected > 0) fmt::format_to(out, "; the bus corrected {}", r.corrected);
    if (r.noticed > 0) fmt::format_to(out, "; the driver noticed {}", r.noticed);
    if (r.unnoticed() > 0) fmt::format_to(out, "; UNNOTICED {}", r.unnoticed());
    if (r.fault.kind == vp::FaultKind::flip) flip_text(out, r);
    fmt::format_to(out, "\n");
  }
}

void error_lines(Out out, const vp::ServoCounts& c) {
  for (std::size_t i = 0; i < c.errors.size(); ++i) {
    const vp::ErrorCount& error = c.errors[i];
    const auto status = static_cast<hvp_status>(i);
    if (error.count == 0) continue;
    fmt::format_to(out, "  ERROR {} {}, first {}: {}\n    remedy: {}\n", hvp_status_name(status),
                   times(error.count),
                   error.first_frame < 0 ? std::string("in set-up")
                                         : fmt::format("in frame {}", error.first_frame),
                   hvp_status_text(status), remedy(status));
  }
}

void consequence_lines(Out out, const Outcome& o) {
  const vp::ServoCounts& c = o.servo;
  if (c.held_frames > 0) {
    fmt::format_to(out,
                   "  held           the last force in {} of {} frames, {} in a row at "
                   "most = {}\n",
                   c.held_frames, o.verdict.frames(), counted(c.longest_hold, "tick"),
                   readable_time(c.longest_hold * o.verdict.period()));
  }
  if (c.recoveries + c.failed_set_ups > 0) {
    fmt::format_to(out, "  board          set up again {}, in vain {}\n", times(c.recoveries),
                   times(c.failed_set_ups));
  }
  const int repeated = c.mended.aborted + c.mended.damaged;
  if (repeated > 0) fmt::format_to(out, "  accesses       repeated {}\n", times(repeated));
  if (c.mended.lost_interrupts > 0) {
    fmt::format_to(out, "  interrupts     lost {}: seen in STATUS at the time-out\n",
                   times(c.mended.lost_interrupts));
  }
  if (c.mended.lost_acknowledgements > 0) {
    fmt::format_to(out, "  acknowledgements lost {}, repeated\n",
                   times(c.mended.lost_acknowledgements));
  }
  if (c.given_up_at >= 0) {
    fmt::format_to(out, "  ERROR the board was given up in frame {} after {} set-ups in vain\n",
                   c.given_up_at, c.failed_set_ups);
  }
}

}  // namespace

std::string fault_text(const Outcome& o) {
  if (o.faults.empty() && !o.faults_happened()) return {};
  std::int64_t injected = 0;
  std::int64_t unnoticed = 0;
  for (const vp::FaultRecord& r : o.faults) {
    injected += r.injected;
    unnoticed += r.unnoticed();
  }
  std::string text = fmt::format("\nFaults       {} injected, {} unnoticed\n", injected, unnoticed);
  const Out out = std::back_inserter(text);
  fault_lines(out, o);
  error_lines(out, o.servo);
  consequence_lines(out, o);
  return text;
}

}  // namespace hvp::results
