#include "models/mesh/smoothing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "models/index.h"

namespace hvp::mesh {

namespace {

using Eigen::Vector3d;

// Only stars with an angle below 18° or above 162° are worked on.
constexpr double kGoodSine = 0.30901699437494742;
constexpr int kSweeps = 3;
constexpr int kHalvings = 3;
constexpr double kFirstStep = 0.2;  // of the star's shortest edge at the node

// The smallest sine of the six dihedral angles, sin θ = 3·V·l / (2·A₁·A₂) for the edge of length
// l between faces of areas A₁ and A₂; not positive for an inverted tetrahedron.
double smallest_sine(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  const double det = jacobian_determinant(a, b, c, d);
  // Twice the area of the face opposite to each corner.
  const double fa = (c - b).cross(d - b).norm();
  const double fb = (c - a).cross(d - a).norm();
  const double fc = (b - a).cross(d - a).norm();
  const double fd = (b - a).cross(c - a).norm();
  const double smallest = std::min({(b - a).norm() / (fc * fd), (c - a).norm() / (fb * fd),
                                    (d - a).norm() / (fb * fc), (c - b).norm() / (fa * fd),
                                    (d - b).norm() / (fa * fc), (d - c).norm() / (fa * fb)});
  return det * (det > 0.0 ? smallest : 1.0);
}

class Smoother {
 public:
  explicit Smoother(TetMesh& mesh) : mesh_(mesh), stars_(mesh.nodes.size()) {
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
      for (const int i : mesh.tetrahedra[e]) stars_[at(i)].push_back(static_cast<int>(e));
    }
    for (const auto& t : mesh.boundary) {
      for (const int i : t) stars_[at(i)].clear();  // these stay where they are
    }
  }

  // Returns whether a node was moved.
  bool sweep() {
    bool moved = false;
    for (std::size_t i = 0; i < stars_.size(); ++i) {
      if (!stars_[i].empty() && improve(i)) moved = true;
    }
    return moved;
  }

 private:
  // Stops at the first tetrahedron that is no better than `hopeless`.
  double worst_sine(std::size_t node, double hopeless) const {
    double worst = std::numeric_limits<double>::infinity();
    for (const int e : stars_[node]) {
      if (worst <= hopeless) break;
      const auto& t = mesh_.tetrahedra[at(e)];
      worst = std::min(worst, smallest_sine(mesh_.nodes[at(t[0])], mesh_.nodes[at(t[1])],
                                            mesh_.nodes[at(t[2])], mesh_.nodes[at(t[3])]));
    }
    return worst;
  }

  double shortest_edge(std::size_t node) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (const int e : stars_[node]) {
      for (const int other : mesh_.tetrahedra[at(e)]) {
        if (at(other) == node) continue;
        shortest = std::min(shortest, (mesh_.nodes[at(other)] - mesh_.nodes[node]).norm());
      }
    }
    return shortest;
  }

  // Tries a step along each axis, both ways, and halves the step where none helps.
  bool improve(std::size_t node) {
    double best = worst_sine(node, -std::numeric_limits<double>::infinity());
    if (best >= kGoodSine) return false;
    bool moved = false;
    double step = kFirstStep * shortest_edge(node);
    for (int halving = 0; halving < kHalvings;) {
      const Vector3d origin = mesh_.nodes[node];
      Vector3d target = origin;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          mesh_.nodes[node] = origin;
          mesh_.nodes[node][axis] += sign * step;
          // A gain in the last bits only would make the search endless.
          const double enough = best * (1.0 + 1e-3);
          const double sine = worst_sine(node, enough);
          if (sine > enough) {
            best = sine;
            target = mesh_.nodes[node];
          }
        }
      }
      mesh_.nodes[node] = target;
      if (target == origin) {
        step *= 0.5;
        ++halving;
      } else {
        moved = true;
      }
    }
    return moved;
  }

  TetMesh& mesh_;
  std::vector<std::vector<int>> stars_;
};

}  // namespace

void smooth(TetMesh& mesh) {
  Smoother smoother(mesh);
  for (int i = 0; i < kSweeps; ++i) {
    if (!smoother.sweep()) return;
  }
}

}  // namespace hvp::mesh
