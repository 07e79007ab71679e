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
  const Hold hold = integrator_.held();
  if (hold.present()) {
    constraint_.reaction(u, integrator_.external_force(), hold.nodes, integrator_.contact_forces());
  }
  integrator_.sum_forces(of_probes);
}

double LinearTissue::force_operations() const {
  const Hold hold = integrator_.held();
  const double fading = integrator_.fading_operations();
  return hold.present() ? fading + constraint_.reaction_flops(hold.nodes) : fading;
}

}  // namespace hvp::fem
