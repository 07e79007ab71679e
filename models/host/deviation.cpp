#include "models/host/deviation.h"

#include <algorithm>
#include <cmath>

namespace hvp::host {

namespace {

constexpr double kParts = 1e12;
// Beyond this an error is as good as infinite; it fits the histogram.
constexpr double kLargestShare = 1e6;

}  // namespace

void Reference::declare(config::Visitor& v) {
  v.integer("every_frames", every_frames, {1, 1'000'000},
            {"compare every so many frames; a dynamic reference still steps in each",
             "every frame, so that no deviation is missed"});
  v.quantity("tolerance", tolerance, config::Dimension::dimensionless, config::between(0, 10),
             {"deviation from the true model above which the run is flagged matrix-rounding",
              "rounding K to 12 bits moves a static solution by 2 to 5 %, docs/fixed-point.md"});
  v.quantity("solver_tolerance", solver_tolerance, config::Dimension::dimensionless,
             config::between(0, 10),
             {"deviation from the rounded model above which the run is flagged not-converged",
              "60 iterations of CG with a warm start reach 1 to 2 %, docs/fixed-point.md"});
  std::vector<std::pair<std::string_view, std::optional<tissue::LawKind>>> models = {
      {"own", std::nullopt}};
  models.insert(models.end(), tissue::law_names().begin(), tissue::law_names().end());
  v.choice("model", model, models,
           {"the law of the true model: the body's own, or another one, with which the run then "
            "shows what its model is worth; budget.displacement_error and force_error are judged "
            "against it, and the tolerances above do not apply",
            "own: what the solver makes of the model that the scenario asks for"});
}

stability::Flags accuracy_flags(const Reference& settings, const std::optional<double>& error,
                                const std::optional<double>& error_rounded) {
  stability::Flags flags;
  constexpr double kClearly = 1.5;
  const bool rounding = !error_rounded || !error || *error > kClearly * *error_rounded;
  if (rounding && error && !(*error <= settings.tolerance)) {
    flags.raise(stability::Flag::matrix_rounding);
  }
  const double solver_bound = std::min(settings.solver_tolerance, settings.tolerance / kClearly);
  if (error_rounded && !(*error_rounded <= solver_bound)) {
    flags.raise(stability::Flag::not_converged);
  }
  return flags;
}

void Deviation::add(std::span<const double> value, std::span<const double> reference,
                    std::int64_t frame, bool in_contact) {
  double difference = 0;
  double norm = 0;
  double own = 0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double d = value[i] - reference[i];
    difference += d * d;
    norm += reference[i] * reference[i];
    own += value[i] * value[i];
  }
  if (!std::isfinite(norm) || !std::isfinite(difference)) undefined_ = true;
  if (undefined_ || (norm == 0 && own == 0)) return;
  const double error = std::sqrt(difference);
  const double size = std::sqrt(norm);
  ++frames_;
  sum_ += error;
  if (worst_frame_ < 0 || error > worst_) {
    worst_ = error;
    worst_frame_ = frame;
  }
  largest_reference_ = std::max(largest_reference_, size);
  if (!in_contact || size == 0) return;
  const double share = error / size;
  shares_.add(std::llround(std::min(share, kLargestShare) * kParts));
  if (share > worst_share_) {
    worst_share_ = share;
    worst_share_frame_ = frame;
  }
}

std::optional<double> Deviation::relative() const {
  if (undefined_ || frames_ == 0 || !(largest_reference_ > 0)) return std::nullopt;
  return sum_ / static_cast<double>(frames_) / largest_reference_;
}

std::optional<double> Deviation::worst_relative() const {
  if (undefined_ || frames_ == 0 || !(largest_reference_ > 0)) return std::nullopt;
  return worst_ / largest_reference_;
}

std::optional<Deviation::OfFrame> Deviation::of_frame() const {
  if (undefined_ || shares_.count() == 0) return std::nullopt;
  const auto share = [&](double of_frames) {
    return static_cast<double>(shares_.percentile(of_frames)) / kParts;
  };
  return OfFrame{shares_.count(), share(0.5), share(0.95), worst_share_, worst_share_frame_};
}

std::optional<double> Deviation::typical() const {
  const std::optional<double> mean = relative();
  const std::optional<OfFrame> own = of_frame();
  if (!own) return mean;
  return std::max(mean.value_or(0), own->median);
}

std::optional<double> Deviation::judged() const {
  // One frame in twenty may be three times as far off.
  constexpr double kOfTheWorst = 1.0 / 3;
  const std::optional<OfFrame> own = of_frame();
  if (!own) return typical();
  return std::max(*typical(), kOfTheWorst * own->p95);
}

void Deviation::OfFrame::report(config::Figures& f) const {
  f.count("frames", frames, "that were compared");
  const auto measurable = [](double share) {
    return share < kLargestShare ? std::optional(share) : std::nullopt;
  };
  f.ratio("median", measurable(median), "half of them are within it; null where it is beyond 1e6");
  f.ratio("p95", measurable(p95), "95 % of them are within it; likewise");
  f.ratio("worst", measurable(worst), "the largest; likewise");
  f.count("worst_frame", worst_frame, "the frame that has it");
}

}  // namespace hvp::host
