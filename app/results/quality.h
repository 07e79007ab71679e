#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/fem/linearity.h"
#include "models/host/deviation.h"
#include "models/host/rounding_estimate.h"

// How good a run's numbers are.
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

  void report(config::Figures& f) const;
};

// A budget of accuracy that the scenario states.
struct ErrorBudget {
  std::string_view of;  // "displacement", "force"
  double limit = 0;
  double p95 = 0;    // of the frames in contact, of their own size
  double worst = 0;  // of all frames, of the run's largest
  bool measured = false;

  bool held() const { return measured && p95 <= limit && worst <= limit; }
  void report(config::Figures& f) const;
};

// How far the body was strained.
struct Strain {
  fem::Strains worst;
  std::int64_t frame = -1;

  void report(config::Figures& f) const;
};

// With [refinement].
struct RefinementFigures {
  int passes = 0;
  double worst_residual = 0;
  std::int64_t widened = 0;

  void report(config::Figures& f) const;
};

}  // namespace hvp::results
