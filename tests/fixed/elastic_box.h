#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "models/sparse/block_matrix.h"

namespace hvp::fixed::test {

// Numbers that are the same with every library and compiler (SplitMix64, Steele et al. 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t bits() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }  // [0, 1)
  double symmetric() { return 2 * uniform() - 1; }
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
  // Nearly normal: the sum of twelve uniform numbers, variance one.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t state_;
};

// A box of cubic cells, six tetrahedra each, held at its face x = 0. It is a second, independent
// way to a stiffness matrix like the thesis', so that this room's tests stand on their own.
struct Box {
  int cells_x = 9, cells_y = 9, cells_z = 9;
  double cell = 0.01;   // m
  double young = 10e3;  // Pa
  double poisson = 0.45;
  double jitter = 0.2;  // of inner nodes, in cells; makes meshes differ
  std::uint64_t seed = 1;
  // Factor on Young's modulus at a cell's centre.
  std::function<double(const Eigen::Vector3d&)> contrast = {};
};

struct Body {
  std::vector<Eigen::Vector3d> position;  // of the free nodes
  sparse::BlockMatrix stiffness;          // the held nodes are removed
  std::vector<double> mass;               // lumped, at a density of 1000 kg/m³

  int nearest(const Eigen::Vector3d& point) const;
};

Body make_body(const Box& box);

// The largest and the smallest eigenvalue by (inverse) power iteration; the smallest is negative
// or NaN-free only for definite matrices.
double condition_number(const sparse::BlockMatrix& matrix);

// matrix with node's row and column cleared and `diagonal` in their place (thesis §3.7).
sparse::BlockMatrix with_contact(const sparse::BlockMatrix& matrix, int node, double diagonal);

// -K_c · displacement for the free nodes, diagonal · displacement for the contact node.
Eigen::VectorXd contact_load(const sparse::BlockMatrix& matrix, int node, double diagonal,
                             const Eigen::Vector3d& displacement);

}  // namespace hvp::fixed::test
