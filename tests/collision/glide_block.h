#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "models/collision/deformed_surface.h"
#include "models/collision/proxy_contact.h"
#include "models/collision/surface_compliance.h"
#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/fem/newmark.h"
#include "models/fem/structured_box.h"
#include "models/index.h"
#include "tests/fem/box_meshes.h"

// The block on which docs/collision.md measures contact that glides: 60 × 60 × 30 mm, E = 10 kPa,
// ν = 0.45, its floor anchored.
namespace hvp::collision::test {

inline const Eigen::Vector3d kBlock(0.06, 0.06, 0.03);

inline fem::Body block(double edge, fem::CellCut cut = fem::CellCut::same,
                       fem::AnchorTreatment treatment = fem::AnchorTreatment::removed) {
  const auto cells = [edge](double length) { return static_cast<int>(length / edge + 0.5); };
  mesh::TetMesh mesh =
      fem::structured_box(kBlock, {cells(kBlock.x()), cells(kBlock.y()), cells(kBlock.z())}, cut);
  const std::vector<int> floor = fem::floor_nodes(mesh);
  return fem::Body(std::move(mesh), fem::Material{}, floor, treatment);
}

// A⁻¹ by Eigen's dense LU.
inline Eigen::MatrixXd dense_inverse(const sparse::BlockMatrix& a) {
  return Eigen::MatrixXd(a.to_eigen()).inverse();
}

// The nine entries of a pair of mesh nodes in it; zero where one does not move.
inline Eigen::Matrix3d dense_block(const fem::Body& body, const Eigen::MatrixXd& inverse, int node,
                                   int other) {
  if (body.active_index(node) < 0 || body.active_index(other) < 0) return Eigen::Matrix3d::Zero();
  if (body.held(node) || body.held(other)) return Eigen::Matrix3d::Zero();
  return inverse.block<3, 3>(3 * body.active_index(node), 3 * body.active_index(other));
}

// Â of a time step of two milliseconds.
inline sparse::BlockMatrix newmark_matrix(const fem::Body& body) {
  const fem::Dynamics dynamics;
  return fem::Newmark(body.stiffness(), body.mass(dynamics.mass), dynamics, 2e-3)
      .effective_matrix();
}

// A block at rest and its contact. The block's answer to the forces is exact. Probes begin on the
// top face.
class Glide {
 public:
  struct Options {
    double friction = 0.3;
    std::vector<double> s0 = {0};
    double edge = 0.01;
    fem::CellCut cut = fem::CellCut::same;
    bool newmark = false;
    std::size_t table = SurfaceCompliance::kLargestTable;
    std::vector<double> patch = {};
  };

  explicit Glide(const Options& options)
      : body(block(options.edge, options.cut)),
        surface(body.mesh()),
        statics(body, body.stiffness(), surface.surface_nodes(), options.table),
        matrix(options.newmark ? newmark_matrix(body) : body.stiffness()),
        other(options.newmark ? std::make_unique<SurfaceCompliance>(
                                    body, matrix, surface.surface_nodes(), options.table)
                              : nullptr),
        solver(matrix),
        contact(body, surface, statics, options.newmark ? *other : statics,
                {.friction = options.friction,
                 .steps = 3,
                 .coupling = options.s0,
                 .patch = options.patch}),
        s0(options.s0),
        u(static_cast<std::size_t>(body.stiffness().rows())),
        free(u.size()) {}

  // The tips' first places on the top face.
  void begin(const std::vector<Eigen::Vector3d>& tips) {
    for (std::size_t i = 0; i < tips.size(); ++i) {
      contact.suggest(i, contact.walk().nearest_at_rest(tips[i]));
    }
    frame(tips);
  }
  const ProxyContact::Probe& frame(const std::vector<Eigen::Vector3d>& tips) {
    contact.look(tips, u);
    contact.solve_free(tips, free);
    u = free;
    std::vector<double> f(u.size());
    fem::add_loads(contact.loads(), f);
    solver.solve(f, f);
    for (std::size_t i = 0; i < u.size(); ++i) u[i] += f[i];
    contact.apply();
    return contact.probes()[0];
  }
  // Frames on the straight line from the present tip to `end`, none longer than `step`.
  void move(
      Eigen::Vector3d& tip, const Eigen::Vector3d& end, double step,
      const std::function<void(const ProxyContact::Probe&, const Eigen::Vector3d&)>& each = {}) {
    const Eigen::Vector3d start = tip;
    const int frames = std::max(1, static_cast<int>(std::ceil((end - start).norm() / step - 1e-9)));
    for (int i = 1; i <= frames; ++i) {
      tip = start + (end - start) * i / frames;
      const ProxyContact::Probe& probe = frame({tip});
      if (each) each(probe, tip);
    }
  }

  // C·A⁻¹·Cᵀ of two spots by the dense inverse of A.
  Eigen::Matrix3d between(const Eigen::MatrixXd& inverse, const SurfaceSpot& a,
                          const SurfaceSpot& b) const {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        sum += a.weight[i] * b.weight[j] *
               dense_block(body, inverse, surface.triangles()[at(a.triangle)][at(i)],
                           surface.triangles()[at(b.triangle)][at(j)]);
      }
    }
    return sum;
  }
  // S by the dense inverse of K, written as the diagonal blocks' mean less the static C·G·Cᵀ.
  Eigen::Matrix3d coupling(const Eigen::MatrixXd& inverse, const SurfaceSpot& spot,
                           double own) const {
    Eigen::Matrix3d sum = own * Eigen::Matrix3d::Identity() - between(inverse, spot, spot);
    for (int i = 0; i < 3; ++i) {
      const int node = surface.triangles()[at(spot.triangle)][at(i)];
      sum += spot.weight[i] * dense_block(body, inverse, node, node);
    }
    return sum;
  }
  // M of all probes.
  Eigen::MatrixXd compliance() const {
    const Eigen::MatrixXd g = dense_inverse(body.stiffness());
    const Eigen::MatrixXd inverse = dense_inverse(matrix);
    const auto probes = static_cast<int>(contact.size());
    Eigen::MatrixXd m(3 * probes, 3 * probes);
    for (int p = 0; p < probes; ++p) {
      for (int q = 0; q < probes; ++q) {
        const SurfaceSpot& a = contact.probes()[at(p)].spot;
        m.block<3, 3>(3 * p, 3 * q) = between(inverse, a, contact.probes()[at(q)].spot);
        if (p == q) m.block<3, 3>(3 * p, 3 * p) += coupling(g, a, s0[at(p)]);
      }
    }
    return m;
  }
  Eigen::Vector3d at_top(double x, double y, double depth = 0) const {
    return {x, y, kBlock.z() - depth};
  }

  fem::Body body;
  DeformedSurface surface;
  SurfaceCompliance statics;
  sparse::BlockMatrix matrix;
  std::unique_ptr<SurfaceCompliance> other;
  fem::DirectSolver solver;
  ProxyContact contact;
  std::vector<double> s0;
  std::vector<double> u, free;
};

inline double normal_force(const ProxyContact::Probe& probe) {
  return -probe.force.dot(probe.normal);
}
inline double tangential_force(const ProxyContact::Probe& probe) {
  return (probe.force + normal_force(probe) * probe.normal).norm();
}

}  // namespace hvp::collision::test
