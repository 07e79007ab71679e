#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/fem/strain.h"
#include "models/host/deviation.h"
#include "models/host/renewal_counts.h"
#include "models/host/rounding_estimate.h"

namespace hvp::app {
class Scene;
}

// The quality of a run's numbers: figures, and their texts for the terminal.

namespace hvp::results {

struct Outcome;

// The distance from the true model and, "rounded", from the rounded model. Absent values: nothing
// was compared.
struct Accuracy {
  struct Quantity {
    // Relative to the run's largest value: the mean over all frames, and the worst frame.
    std::optional<double> mean;
    std::optional<double> worst;
    std::int64_t worst_frame = -1;
    std::optional<double> mean_rounded;
    // Relative to the frame's own value, in contact.
    std::optional<host::Deviation::OfFrame> of_frame;
    std::optional<host::Deviation::OfFrame> of_frame_rounded;
  };
  Quantity displacement;
  Quantity force;
  std::int64_t frames = 0;      // frames compared, without those in which the body is at rest
  std::int64_t in_contact = 0;  // frames in contact, compared or not
  std::int64_t compared = 0;    // those of `in_contact` that were compared
  // Of a body that is not linear: the frames whose true solution was not found, and the tangents on
  // the way to the others that were not positive definite.
  std::int64_t unsolved = 0;
  std::int64_t indefinite = 0;
  // The true model is of another material law than the body: its distance is the model's, and says
  // nothing of the solver unless a budget is stated for it.
  bool of_another_model = false;

  // True if the frames compared speak for all frames in contact: each was compared, or so many
  // that one in twenty, which the percentiles leave out, is at least one frame.
  bool speaks_for_all(const Quantity& quantity) const;

  void report(config::Figures& f) const;
};

// A budget of accuracy that the scenario states.
struct ErrorBudget {
  std::string_view of;  // "displacement", "force"
  double limit = 0;
  double p95 = 0;               // over the frames in contact, relative to each frame's own value
  double worst = 0;             // over all frames compared, relative to the run's largest value
  std::int64_t compared = 0;    // frames in contact that were compared
  std::int64_t in_contact = 0;  // all frames in contact
  bool measured = false;        // false too where too few were compared

  bool held() const { return measured && p95 <= limit && worst <= limit; }
  void report(config::Figures& f) const;
};

// The largest strain of the body, and the frame that has it.
struct Strain {
  fem::Strains worst;
  std::int64_t frame = -1;

  void report(config::Figures& f) const;
};

// Explicit time steps, where they take a solver's place.
struct ExplicitFigures {
  int substeps = 0;
  double substep_s = 0;
  double limit_at_rest_s = 0;
  double least_limit_s = 0;

  void report(config::Figures& f) const;
};

// The figures of refinement, with [refinement].
struct RefinementFigures {
  int passes = 0;
  double worst_residual = 0;
  std::int64_t widened = 0;
  std::int64_t without_start = 0;
  std::int64_t first_without_start = -1;

  void report(config::Figures& f) const;
};

// What became of the matrix' renewals, with [object.model.matrix].
struct MatrixFigures {
  host::RenewalCounts counts;

  void report(config::Figures& f) const;
};

// The terminal's section on the distance from double precision.
std::string accuracy_text(const app::Scene& scene, const Outcome& outcome);

// The terminal's section on force and strain; empty where no force was computed.
std::string force_text(const Outcome& outcome);

}  // namespace hvp::results
