#include "app/results/quality.h"

#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::results {

namespace {

std::optional<double> measurable(const std::optional<double>& ratio) {
  return ratio && *ratio < kMeasurable ? ratio : std::nullopt;
}

}  // namespace

bool Accuracy::speaks_for_all(const Quantity& quantity) const {
  constexpr std::int64_t kEnough = 20;
  if (!quantity.of_frame) return false;
  return compared == in_contact || quantity.of_frame->frames >= kEnough;
}

void Accuracy::report(config::Figures& f) const {
  f.ratio(
      "displacement_rel", measurable(displacement.mean),
      "mean of |v - v_ref| over the frames compared, divided by the run's largest |v_ref|. v_ref "
      "is the double-precision solution of the true (unrounded) system. Frames in which nothing "
      "moves are not compared. null, here and below, where it is beyond 1e6");
  f.ratio("force_rel", measurable(force.mean), "likewise");
  f.ratio("displacement_rel_quantised", measurable(displacement.mean_rounded),
          "the mean, against the system as the matrix' words have it");
  f.ratio("force_rel_quantised", measurable(force.mean_rounded), "likewise");
  f.ratio("displacement_worst_rel", measurable(displacement.worst),
          "of the frame that is worst by this measure");
  f.frame("displacement_worst_frame", displacement.worst_frame, "which that is");
  f.ratio("force_worst_rel", measurable(force.worst), "likewise");
  f.frame("force_worst_frame", force.worst_frame, "which that is");
  f.count("frames", frames, "that were compared");
  f.count("frames_in_contact", in_contact, "with contact, compared or not");
  f.count("unsolved_frames", unsolved, "whose true solution was not found to rounding");
  f.count("indefinite_tangents", indefinite,
          "of a body that is not linear: tangents on the way to the true solution that were not "
          "positive definite. It gave way there, as in buckling, and may have another solution");
  f.table_or_null(
      "displacement_of_frame",
      "|v - v_ref|/|v_ref| over the frames in contact. Percentiles are right within one "
      "part in 64",
      displacement.of_frame);
  f.table_or_null("force_of_frame", "likewise", force.of_frame);
  f.table_or_null(
      "displacement_of_frame_quantised",
      "against the system as the matrix' words have it: the solver's own error. A "
      "refined run heads for the true system: there it tells where the words alone would "
      "have led",
      displacement.of_frame_rounded);
  f.table_or_null("force_of_frame_quantised", "likewise", force.of_frame_rounded);
}

void ErrorBudget::report(config::Figures& f) const {
  const auto figure = [this](double value) { return measured ? measurable(value) : std::nullopt; };
  f.ratio("limit_rel", limit, "what the scenario states");
  f.ratio("p95_rel", figure(p95), "95 % of the frames in contact are within it, of their own size");
  f.ratio("worst_rel", figure(worst), "of all frames compared, of the run's largest");
  f.count("compared", compared, "frames in contact that were compared");
  f.count("in_contact", in_contact,
          "all frames in contact. Unless each is compared it takes twenty to measure 95 % of them");
  f.truth("held", held(), "both are within the limit");
}

void Strain::report(config::Figures& f) const {
  f.ratio("largest", worst.largest, "the largest principal strain");
  f.frame("frame", frame, "the frame that has it");
  f.ratio("beyond_limit_share", worst.beyond_share,
          "the largest share of the volume beyond a strain of a tenth");
  f.ratio("stretched_share", worst.stretched_share,
          "the part of it that is stretched so far, rotations taken out");
  f.count("inverted_elements", worst.inverted, "turned inside out");
  f.text("suitable_model", fem::suitable_model(worst),
         "the simplest object.model.kind that these strains are not beyond, by the rule of "
         "beyond-linearity. The force at a pressed node may still differ: reference.model says by "
         "how much");
}

void ExplicitFigures::report(config::Figures& f) const {
  f.count("substeps", substeps, "time steps a frame");
  f.mean_time("substep_us", 1e12 * substep_s, "the length of each");
  f.mean_time("limit_at_rest_us", 1e12 * limit_at_rest_s,
              "the longest stable one of the body at rest");
  f.mean_time("least_limit_us", 1e12 * least_limit_s,
              "the least of the estimates in this run, one a frame, which are above the true limit "
              "by 0.2 % when settled");
}

void MatrixFigures::report(config::Figures& f) const {
  f.count("renewed", counts.renewed, "times that the solver got the matrix of the deformed body");
  f.count("not_defined", counts.undefined,
          "times that elements had no tangent, or the matrix no factors, and the one before "
          "stayed");
  f.count("beyond_scale", counts.beyond,
          "times that entries did not fit their words, and the matrix before stayed");
  f.count("words_beyond", counts.words_beyond, "those entries");
  f.count("projected_elements", counts.projected,
          "elements whose tangent was made semidefinite, the most in a renewal");
  f.ratio("growth", counts.growth > 0 ? std::optional(counts.growth) : std::nullopt,
          "the largest entry of a renewed matrix over that of the body at rest: the headroom that "
          "it needs; null where none was formed");
}

void RefinementFigures::report(config::Figures& f) const {
  f.count("passes", passes, "solves a frame");
  f.ratio("worst_residual_rel", worst_residual,
          "the largest ‖b - A·u‖ that a frame left, over the largest ‖b‖ up to it");
  f.count("widened", widened, "passes whose increment did not fit its words");
  f.count("frames_without_start", without_start,
          "that kept the last solution, since elements had no forces with the contact in its "
          "place. The largest residual is of the others");
  f.frame("first_without_start", first_without_start, "the first of them");
}

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

void mean_line(Out out, std::string_view what, const Accuracy::Quantity& q,
               std::int64_t in_contact) {
  if (!q.mean) {
    fmt::format_to(out, "  {:<14} {}\n", what, in_contact == 0 ? "no contact" : "not measurable");
    return;
  }
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
  const app::Scenario& s = scene.scenario();
  const std::string true_model = s.judged_by_another_model()
                                     ? fmt::format("{} model", tissue::name(*s.reference->model))
                                     : "true model";
  if (a.displacement.of_frame && a.force.of_frame) {
    fmt::format_to(out,
                   "\nAccuracy     error against the {}, of the frame's own displacement "
                   "and force, {} in contact\n",
                   true_model, counted(a.displacement.of_frame->frames, "frame"));
    of_frame_line(out, "displacement", a.displacement);
    of_frame_line(out, "contact force", a.force);
    fmt::format_to(out, "  of the run's largest, over all {} in which the body is displaced\n",
                   counted(a.frames, "frame"));
  } else {
    fmt::format_to(out,
                   "\nAccuracy     error against the {}, of the run's largest, over all {} "
                   "in which the body is displaced\n",
                   true_model, counted(a.frames, "frame"));
  }
  mean_line(out, "displacement", a.displacement, a.in_contact);
  mean_line(out, "contact force", a.force, a.in_contact);
  if (a.unsolved > 0) {
    fmt::format_to(out, "  of the true model {} could not be solved\n",
                   counted(a.unsolved, "frame"));
  }
  if (a.indefinite > 0) {
    fmt::format_to(out,
                   "  {} of the true model not positive definite: the body gave way, as in "
                   "buckling\n",
                   counted(a.indefinite, "tangent"));
  }
  if (!o.accuracy_measured()) {
    if (a.of_another_model) {
      fmt::format_to(out,
                     "  That is the distance of two models: of the solver nothing is measured. "
                     "budget.displacement_error\n  and force_error judge it.\n");
    } else if (a.in_contact == 0) {
      fmt::format_to(out, "  No frame was in contact: that is too little to call it measured.\n");
    } else {
      fmt::format_to(out, "  That is too few of {} in contact to call it measured.\n",
                     counted(a.in_contact, "frame"));
    }
    rounding_lines(out, o);
  }
  if (!a.displacement.mean_rounded) return text;
  if (scene.scenario().refinement) {
    fmt::format_to(out,
                   "  Both models are solved in double precision. The rounded one is where the "
                   "board would end\n  without refinement; the passes lead to the true one.");
  } else {
    fmt::format_to(
        out,
        "  Both models are solved in double precision. The rounded one has the matrix as "
        "the board's\n  words hold it: its figure is the solver's own error, the rest "
        "is the rounding.");
  }
  text +=
      scene.glide() != nullptr
          ? " Each finds\n  its contact by itself from the tip.\n"
          : " When and where\n  contact was found is the run's own in both: its error is not in "
            "these figures.\n";
  return text;
}

namespace {

void force_lines(Out out, const stability::ForceQuality& force, const ContactFigures& contact) {
  fmt::format_to(out, "\nForce        largest {} (frame {}), contact in {} of the frames\n",
                 newtons(force.peak().value), force.peak().frame, percent(contact.share()));
  if (const ProxyFigures& proxy = contact.proxy; proxy.touches > 0) {
    fmt::format_to(
        out, "  proxy          glides in {} of its frames; up to {} from the tip (frame {})\n",
        percent(static_cast<double>(proxy.sliding) / static_cast<double>(proxy.touches)),
        readable_length(proxy.largest_gap), proxy.frame);
  }
  fmt::format_to(out, "  step           {} from one frame to the next, {} of it (frame {})\n",
                 newtons(force.step().value), percent(force.step_share()), force.step().frame);
  for (std::size_t i = 0; i < stability::ForceQuality::kSpans.size(); ++i) {
    const stability::WorstFrame change = force.handed_over(i);
    if (!(change.value > stability::ForceQuality::kNoticeable)) continue;
    fmt::format_to(out,
                   "  handed over    the force changes by {} of itself within {:g} ms (frame {})\n",
                   percent(change.value), 1e3 * stability::ForceQuality::kSpans[i], change.frame);
  }
  if (force.alternations() > 0) {
    fmt::format_to(out, "  alternations   {} within {:g} s\n", force.alternations(),
                   stability::ForceQuality::kWindowSeconds);
  }
  if (force.pull().frame >= 0) {
    fmt::format_to(out, "  pull           up to {} (frame {}): contact ends a pass late\n",
                   newtons(force.pull().value), force.pull().frame);
  }
  if (const std::optional<double> ripple = force.ripple(); ripple.value_or(0) > 0) {
    fmt::format_to(out, "  at rest        moves by {} peak to peak while the tip rests\n",
                   percent(*ripple));
  }
}

void strain_line(Out out, const fem::Strains& strain, bool beyond_linearity) {
  fmt::format_to(out,
                 "  strain         up to {}, {} of the volume beyond {}; {} turned inside out\n",
                 percent(strain.largest), percent(strain.beyond_share), percent(fem::kLinearStrain),
                 counted(strain.inverted, "element"));
  if (!beyond_linearity) return;
  fmt::format_to(
      out,
      "  stretched      {}{} of the volume beyond {} once turns are taken out: that asks "
      "for a {} body\n",
      strain.largest_stretch >= fem::kCollapse
          ? fmt::format("up to {}, ", percent(strain.largest_stretch))
          : std::string(),
      percent(strain.stretched_share), percent(fem::kLinearStrain), fem::suitable_model(strain));
}

}  // namespace

std::string force_text(const Outcome& o) {
  std::string text;
  const Out out = std::back_inserter(text);
  if (o.contact.missed) {
    fmt::format_to(
        out, "\nContact      none in frame {}, though the tip was {} inside the body: no force\n",
        o.contact.missed->frame, readable_length(-o.contact.missed->distance));
  }
  if (!o.force || o.force->peak().frame < 0) return text;
  force_lines(out, *o.force, o.contact);
  for (std::size_t i = 1; i < o.forces.size(); ++i) {
    fmt::format_to(out, "  probe {}        largest {} (frame {}), step {} of it\n", i,
                   newtons(o.forces[i].peak().value), o.forces[i].peak().frame,
                   percent(o.forces[i].step_share()));
  }
  if (o.strain) {
    strain_line(out, o.strain->worst, o.flags.has(stability::Flag::beyond_linearity));
  }
  return text;
}

}  // namespace hvp::results
