#include "models/fem/tissue.h"

#include <algorithm>

namespace hvp::fem {

LinearTissue::LinearTissue(const Body& body, ContactDiagonal diagonal,
                           const std::optional<Dynamics>& dynamics, double period_s, Effort effort)
    : effort_(effort),
      integrator_(body, body.load(), dynamics, period_s, effort),
      matrix_(dynamics ? integrator_.newmark()->effective_matrix() : body.stiffness()),
      constraint_(matrix_, diagonal),
      internal_(matrix_) {}

void LinearTissue::forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) {
  if (effort_ == Effort::counted) {
    std::ranges::fill(of_probes, Eigen::Vector3d::Zero());
    return;
  }
  integrator_.find_contact_forces(constraint_, u);
  integrator_.sum_forces(of_probes);
}

double LinearTissue::force_operations() const {
  return integrator_.fading_operations() + integrator_.contact_force_operations(constraint_);
}

}  // namespace hvp::fem
