#include "app/results/quality_json.h"

#include <nlohmann/json.hpp>
#include <optional>

namespace hvp::results {

namespace {

using nlohmann::ordered_json;

ordered_json nullable(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json frame(std::int64_t number) {
  return number >= 0 ? ordered_json(number) : ordered_json(nullptr);
}

ordered_json of_frame(const std::optional<host::Deviation::OfFrame>& f) {
  if (!f) return nullptr;
  return {{"frames", f->frames},
          {"median", f->median},
          {"p95", f->p95},
          {"worst", f->worst},
          {"worst_frame", f->worst_frame}};
}

ordered_json worst(const stability::WorstFrame& w, const char* name) {
  return {{name, w.value}, {"frame", frame(w.frame)}};
}

}  // namespace

ordered_json accuracy_json(const Outcome& o) {
  const Accuracy none;
  const Accuracy& a = o.accuracy ? *o.accuracy : none;
  ordered_json j;
  j["measured"] = o.accuracy.has_value();
  j["displacement_rel"] = nullable(a.displacement.mean);
  j["force_rel"] = nullable(a.force.mean);
  j["displacement_rel_quantised"] = nullable(a.displacement.mean_rounded);
  j["force_rel_quantised"] = nullable(a.force.mean_rounded);
  j["displacement_worst_rel"] = nullable(a.displacement.worst);
  j["displacement_worst_frame"] = frame(a.displacement.worst_frame);
  j["force_worst_rel"] = nullable(a.force.worst);
  j["force_worst_frame"] = frame(a.force.worst_frame);
  j["frames"] = a.frames;
  j["displacement_of_frame"] = of_frame(a.displacement.of_frame);
  j["force_of_frame"] = of_frame(a.force.of_frame);
  j["displacement_of_frame_quantised"] = of_frame(a.displacement.of_frame_rounded);
  j["force_of_frame_quantised"] = of_frame(a.force.of_frame_rounded);
  j["rounding"] = nullptr;
  if (o.rounding) {
    j["rounding"] = {{"positive_definite", o.rounding->positive_definite},
                     {"resting_positive_definite", o.rounding->resting_positive_definite},
                     {"negative_eigenvalues", o.rounding->negative_eigenvalues},
                     {"contacts", o.rounding->contacts}};
    const std::optional<host::RoundingEstimate::Error>& error = o.rounding->error;
    j["rounding"]["displacement_rel"] = error ? ordered_json(error->displacement) : nullptr;
    j["rounding"]["force_rel"] = error ? ordered_json(error->force) : nullptr;
  }
  return j;
}

ordered_json force_json(const Outcome& o) {
  if (!o.force) return nullptr;
  const stability::ForceQuality& f = *o.force;
  ordered_json j;
  j["largest"] = worst(f.peak(), "N");
  j["step"] = worst(f.step(), "N");
  j["step"]["of_largest_rel"] = f.step_share();
  j["alternations"] = f.alternations();
  j["pull"] = worst(f.pull(), "N");
  j["ripple_rel"] = nullable(f.ripple());
  return j;
}

ordered_json strain_json(const Outcome& o) {
  if (!o.strain) return nullptr;
  return {{"largest", o.strain->worst.largest},
          {"frame", frame(o.strain->frame)},
          {"beyond_limit_share", o.strain->worst.beyond_share},
          {"inverted_elements", o.strain->worst.inverted}};
}

}  // namespace hvp::results
