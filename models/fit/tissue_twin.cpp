#include "models/fit/tissue_twin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>

#include "models/fem/direct_solver.h"
#include "models/fem/linear_tissue.h"
#include "models/random/draws.h"

namespace hvp::fit {

std::vector<double> press_and_sweep(const PressAndSweep& motion, double period_s) {
  const auto frames = static_cast<std::size_t>(std::llround(motion.duration / period_s));
  std::vector<double> displacement;
  displacement.reserve(frames);
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) * period_s;
    const double risen = std::min(t / motion.rise, 1.0);
    const double since = std::max(0.0, t - motion.rise);
    displacement.push_back(motion.press / 2 * (1 - std::cos(std::numbers::pi * risen)) +
                           motion.sweep *
                               std::sin(std::numbers::pi * motion.quickens * since * since));
  }
  return displacement;
}

TissueLog touch(const TissueBody& body, const TissueValues& values, const std::vector<int>& nodes,
                const Eigen::Vector3d& direction, const std::vector<double>& displacement,
                double noise, std::int64_t seed) {
  const fem::Body solid(body.mesh,
                        {.young_modulus_pa = values.young_modulus,
                         .poisson_ratio = values.poisson_ratio,
                         .density_kg_m3 = body.density_kg_m3},
                        body.anchored, fem::AnchorTreatment::removed);
  std::optional<fem::Dynamics> dynamics = body.dynamics;
  if (dynamics) {
    dynamics->rayleigh_mass = values.mass_damping;
    dynamics->rayleigh_stiffness = values.stiffness_damping;
  }
  fem::LinearTissue tissue(solid, fem::ContactDiagonal::average, dynamics, body.period_s,
                           fem::Effort::computed);
  fem::DirectSolver solver(tissue.system());
  const std::span<const double> rest = tissue.initial_displacement();
  std::vector<double> u(rest.begin(), rest.end());
  std::vector<int> active;
  active.reserve(nodes.size());
  for (const int node : nodes) active.push_back(solid.active_index(node));
  const Eigen::Vector3d along = direction.normalized();
  const double elapsed = body.velocity_of_way ? body.period_s : 0;
  const random::Draws draws(seed, "touch");
  TissueLog log{nodes, direction, {}, displacement, {}};
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const std::vector<Eigen::Vector3d> place(nodes.size(), displacement[i] * along);
    tissue.hold({.nodes = active, .displacement = place, .let_go = {}, .elapsed_s = elapsed});
    solver.solve_with_contact(tissue.load(), active, place, u);
    std::array<Eigen::Vector3d, 1> force;
    tissue.forces(u, force);
    tissue.advance(u);
    // Box & Muller.
    const random::Draws::Pair drawn = draws.uniform(static_cast<std::int64_t>(i));
    const double normal =
        std::sqrt(-2 * std::log(drawn.first)) * std::cos(2 * std::numbers::pi * drawn.second);
    log.time.push_back(static_cast<double>(i) * body.period_s);
    log.force.push_back(force[0].dot(along) + noise * normal);
  }
  return log;
}

}  // namespace hvp::fit
