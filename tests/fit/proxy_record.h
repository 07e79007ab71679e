#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "models/fem/tissue.h"
#include "models/fit/tissue_proxy_frames.h"
#include "models/host/gliding_contact.h"
#include "models/host/reference_run.h"
#include "tests/fit/tissue_record.h"

namespace hvp::fit {

// The frames of a run whose contact is a proxy, as the platform's reference computes them. It
// shares the compliance of the surface and the coupling with the fitted model, and no more.
inline GlidingFrames glide(const TissueBody& body, const TissueValues& values,
                           const std::vector<Eigen::Vector3d>& tips, const ProxyProbe& probe) {
  const fem::Body solid(body.mesh,
                        fem::Material{.young_modulus_pa = values.young_modulus,
                                      .poisson_ratio = values.poisson_ratio,
                                      .density_kg_m3 = body.density_kg_m3},
                        body.anchored, fem::AnchorTreatment::removed);
  std::optional<fem::Dynamics> dynamics = body.dynamics;
  if (dynamics) {
    dynamics->rayleigh_mass = values.mass_damping;
    dynamics->rayleigh_stiffness = values.stiffness_damping;
  }
  const fem::LinearTissue tissue(solid, fem::ContactDiagonal::average, dynamics, body.period_s,
                                 fem::Effort::computed);
  const sparse::BlockMatrix& system = tissue.system();
  const std::array<double, 1> radii = {probe.radius_m};
  const host::GlideTables tables(solid, system, dynamics.has_value(), true,
                                 collision::ContactSettings{.friction = probe.friction}, radii);
  auto own = std::make_unique<host::GlidingContact>(solid, tables);
  const host::GlidingContact& contact = *own;
  host::GlidingReference reference(
      std::make_unique<host::ReferenceRun>(solid, dynamics, body.period_s, system, system),
      std::move(own));
  GlidingFrames frames;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const std::array<Eigen::Vector3d, 1> tip = {tips[i]};
    reference.step(fem::Hold::of_loads({}, tip));
    collision::Touch touch;
    contact.describe(0, touch);
    frames.time.push_back(static_cast<double>(i) * body.period_s);
    frames.tip.push_back(tips[i]);
    frames.contact_node.push_back(touch.contact.node);
    frames.force.emplace_back(-touch.force);
    frames.foot.push_back(touch.foot);
    frames.slides.push_back(touch.slides);
  }
  return frames;
}

// Tips that go down onto the block's top, at a place between nodes, and then shake by `aside` along
// x, m.
inline std::vector<Eigen::Vector3d> shaken_tips(int frames, double period_s, double aside = 0) {
  const std::vector<double> depth = shaken(frames, period_s);
  std::vector<Eigen::Vector3d> tips;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(depth.size());
    tips.emplace_back(0.047 + aside * std::sin(9 * t), 0.052, 0.1005 - depth[i]);
  }
  return tips;
}

}  // namespace hvp::fit
