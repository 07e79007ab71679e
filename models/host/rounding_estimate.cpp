#include "models/host/rounding_estimate.h"

#include <algorithm>

#include "models/fem/direct_solver.h"
#include "models/host/deviation.h"
#include "models/host/reference_run.h"

namespace hvp::host {

namespace {

// K + Ã − A, in the pattern that all three share.
sparse::BlockMatrix stationary_stiffness(const sparse::BlockMatrix& k, const sparse::BlockMatrix& a,
                                         const sparse::BlockMatrix& rounded) {
  sparse::BlockMatrix result = k;
  for (std::size_t i = 0; i < result.value.size(); ++i) {
    result.value[i] += rounded.value[i] - a.value[i];
  }
  return result;
}

std::span<const double> components(const Eigen::Vector3d& v) { return {v.data(), 3}; }

// The error of one contact; empty where the true model does not move.
std::optional<double> error(std::span<const double> value, std::span<const double> reference) {
  Deviation deviation;
  deviation.add(value, reference);
  return deviation.worst_relative();
}

}  // namespace

RoundingEstimate estimate_rounding(const fem::Body& body, const sparse::BlockMatrix& a,
                                   const sparse::BlockMatrix& rounded,
                                   std::span<const UnitContact> contacts) {
  const sparse::BlockMatrix& k = body.stiffness();
  const sparse::BlockMatrix resting = stationary_stiffness(k, a, rounded);
  ReferenceRun truth(body, std::nullopt, 0, k, k);
  ReferenceRun words(body, std::nullopt, 0, k, resting);
  const fem::DirectSolver board(rounded);

  RoundingEstimate estimate;
  estimate.positive_definite = board.positive_definite();
  estimate.resting_positive_definite = words.positive_definite();
  estimate.negative_eigenvalues =
      std::max(board.negative_eigenvalues(), words.negative_eigenvalues());
  if (words.singular() || truth.singular()) return estimate;
  std::vector<Eigen::Vector3d> held;
  for (const UnitContact& contact : contacts) {
    held.assign(contact.nodes.size(), contact.displacement);
    const fem::Hold hold{contact.nodes, held, {}, 0};
    truth.step(hold);
    words.step(hold);
    const std::optional<double> displacement = error(words.displacement(), truth.displacement());
    if (!displacement) continue;
    ++estimate.contacts;
    if (!estimate.error) estimate.error = RoundingEstimate::Error{};
    estimate.error->displacement = std::max(estimate.error->displacement, *displacement);
    if (contact.nodes.empty()) continue;
    const std::optional<double> force = error(components(words.force()), components(truth.force()));
    estimate.error->force = std::max(estimate.error->force, force.value_or(0));
  }
  return estimate;
}

stability::Flags RoundingEstimate::flags(bool refined, bool measured) const {
  stability::Flags flags;
  if (!definite(refined)) flags.raise(stability::Flag::negative_curvature);
  if (measured || refined) return flags;
  if (!error || error->displacement > Reference{}.tolerance) {
    flags.raise(stability::Flag::matrix_rounding);
  }
  return flags;
}

void RoundingEstimate::report(config::Figures& f) const {
  f.truth("positive_definite", positive_definite, "of the matrix in words");
  f.truth("resting_positive_definite", resting_positive_definite,
          "of the stiffness that a resting body has with it");
  f.count("negative_eigenvalues", negative_eigenvalues, "of the matrix in words");
  f.count("contacts", contacts, "that were compared");
  const auto of = [this](double Error::*figure) -> std::optional<double> {
    return error ? std::optional((*error).*figure) : std::nullopt;
  };
  f.ratio("displacement_rel", of(&Error::displacement),
          "the largest |u - u_true|/|u_true| of them, or null");
  f.ratio("force_rel", of(&Error::force), "likewise of the force");
}

}  // namespace hvp::host
