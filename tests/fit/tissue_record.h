#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/direct_solver.h"
#include "models/fem/linear_tissue.h"
#include "models/fit/tissue_problem.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fit {

// A block of 10 cm on the floor.
inline TissueBody soft_block(int cells, const std::optional<fem::Dynamics>& dynamics) {
  TissueBody body;
  body.mesh = fem::jittered_box({0.1, 0.1, 0.1}, {cells, cells, cells});
  body.anchored = fem::floor_nodes(body.mesh);
  body.dynamics = dynamics;
  return body;
}

inline fem::Dynamics damped_newmark() { return {.newmark_beta = 0.605, .newmark_gamma = 0.6}; }

inline constexpr TissueValues kTrueTissue = {8e3, 0.42, 6.0, 2e-3};

// The node of the mesh that is nearest to a place.
inline int node_near(const TissueBody& body, const Eigen::Vector3d& place) {
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < body.mesh.nodes.size(); ++i) {
    if ((body.mesh.nodes[i] - place).norm() < (body.mesh.nodes[nearest] - place).norm()) {
      nearest = i;
    }
  }
  return static_cast<int>(nearest);
}

// A press of 4 mm in a fifth of a second, then a sweep of 1 mm that gets faster: m.
inline std::vector<double> press_and_sweep(int samples, double period_s) {
  std::vector<double> x;
  for (int i = 0; i < samples; ++i) {
    const double t = i * period_s;
    const double press = 2e-3 * (1 - std::cos(std::numbers::pi * std::min(t / 0.2, 1.0)));
    const double sweep =
        t < 0.2 ? 0 : 1e-3 * std::sin(2 * std::numbers::pi * 30 * (t - 0.2) * (t - 0.2));
    x.push_back(press + sweep);
  }
  return x;
}

// What the platform's own body answers: its linear tissue with the direct solver, as the servo loop
// goes through a frame.
inline TissueLog record(const TissueBody& body, const TissueValues& values,
                        const std::vector<int>& nodes, const Eigen::Vector3d& direction,
                        const std::vector<double>& displacement) {
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
  std::vector<double> u(tissue.initial_displacement().begin(), tissue.initial_displacement().end());
  std::vector<int> active;
  for (const int node : nodes) active.push_back(solid.active_index(node));
  const Eigen::Vector3d d = direction.normalized();
  TissueLog log{nodes, direction, {}, displacement, {}};
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    const std::vector<Eigen::Vector3d> place(nodes.size(), displacement[i] * d);
    const double elapsed = body.velocity_of_way ? body.period_s : 0;
    tissue.hold({.nodes = active, .displacement = place, .let_go = {}, .elapsed_s = elapsed});
    solver.solve_with_contact(tissue.load(), active, place, u);
    std::array<Eigen::Vector3d, 1> force;
    tissue.forces(u, force);
    tissue.advance(u);
    log.time.push_back(static_cast<double>(i) * body.period_s);
    log.force.push_back(force[0].dot(d));
  }
  return log;
}

}  // namespace hvp::fit
