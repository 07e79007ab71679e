#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/results/report_sections.h"

namespace hvp::results {

namespace {

using Out = std::back_insert_iterator<std::string>;

std::string ratio(const std::optional<double>& value) {
  return value ? percent(*value) : std::string("not measurable");
}

void of_frame_line(Out out, std::string_view what, const Accuracy::Quantity& q) {
  const host::Deviation::OfFrame& f = *q.of_frame;
  fmt::format_to(out, "  {:<14} median {}, 95 % {}, worst {} (frame {})", what, percent(f.median),
                 percent(f.p95), percent(f.worst), f.worst_frame);
  if (q.of_frame_rounded) {
    fmt::format_to(out, "; from the rounded model {}", percent(q.of_frame_rounded->median));
  }
  fmt::format_to(out, "\n");
}

void mean_line(Out out, std::string_view what, const Accuracy::Quantity& q) {
  fmt::format_to(out, "  {:<14} mean {}, worst {} (frame {})", what, ratio(q.mean), ratio(q.worst),
                 q.worst_frame);
  if (q.mean_rounded) fmt::format_to(out, "; from the rounded model {}", percent(*q.mean_rounded));
  fmt::format_to(out, "\n");
}

void rounding_lines(Out out, const Outcome& o) {
  if (!o.rounding) return;
  const host::RoundingEstimate& r = *o.rounding;
  if (!r.error) {
    fmt::format_to(out, "  The matrix' words have no solution that could be compared.\n");
    return;
  }
  fmt::format_to(out,
                 "  {} along the probe's way, at rest: the words of the matrix alone move the\n"
                 "  displacement by up to {}, the force by up to {}\n",
                 counted(r.contacts, "contact"), percent(r.error->displacement),
                 percent(r.error->force));
}

}  // namespace

std::string accuracy_text(const app::Scene& scene, const Outcome& o) {
  std::string text;
  const Out out = std::back_inserter(text);
  if (scene.scenario().timing_only()) {
    return "\nAccuracy     timing only: there are no numbers to compare\n";
  }
  if (!o.accuracy) {
    fmt::format_to(out, "\nAccuracy     not measured: add [reference] to the scenario\n");
    rounding_lines(out, o);
    return text;
  }
  const Accuracy& a = *o.accuracy;
  if (!a.displacement.mean) {
    fmt::format_to(out,
                   "\nAccuracy     nothing to compare: no frame that was compared had the body "
                   "displaced\n");
    rounding_lines(out, o);
    return text;
  }
  if (a.displacement.of_frame && a.force.of_frame) {
    fmt::format_to(out,
                   "\nAccuracy     error against the true model, of the frame's own displacement "
                   "and force, {} in contact\n",
                   counted(a.displacement.of_frame->frames, "frame"));
    of_frame_line(out, "displacement", a.displacement);
    of_frame_line(out, "contact force", a.force);
    fmt::format_to(out, "  of the run's largest, over all {} in which the body is displaced\n",
                   counted(a.frames, "frame"));
  } else {
    fmt::format_to(out,
                   "\nAccuracy     error against the true model, of the run's largest, over all {} "
                   "in which the body is displaced\n",
                   counted(a.frames, "frame"));
  }
  mean_line(out, "displacement", a.displacement);
  mean_line(out, "contact force", a.force);
  if (!o.accuracy_measured()) {
    fmt::format_to(out, "  That is too few of {} in contact to call it measured.\n",
                   counted(a.in_contact, "frame"));
    rounding_lines(out, o);
  }
  if (!a.displacement.mean_rounded) return text;
  if (scene.scenario().refinement) {
    fmt::format_to(
        out,
        "  Both models are solved in double precision. The rounded one is where the "
        "board would end\n  without refinement; the passes lead to the true one. When and "
        "where contact was found is\n  the run's own in both: its error is not in these "
        "figures.\n");
  } else {
    fmt::format_to(
        out,
        "  Both models are solved in double precision. The rounded one has the matrix as "
        "the board's\n  words hold it: its figure is the solver's own error, the rest "
        "is the rounding. When and where\n  contact was found is the run's own in both: its error "
        "is not in these figures.\n");
  }
  return text;
}

}  // namespace hvp::results
