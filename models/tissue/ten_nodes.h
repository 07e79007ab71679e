#pragma once

#include <array>
#include <cstddef>

#include "models/fem/quadratic_element.h"
#include "models/mesh/tet_mesh.h"
#include "models/tissue/element.h"
#include "models/tissue/operations.h"
#include "models/tissue/tensor.h"

namespace hvp::tissue {

// The kinematics of a tetrahedron with four or ten nodes (fem/quadratic_element.h), at its points
// of integration, which have equal weights. With straight sides the gradients of all ten nodes are
// sums of the four ∇Λ: ∇N_a = (4L_a − 1)·∇Λ_a at a corner, ∇N_ab = 4·(L_a·∇Λ_b + L_b·∇Λ_a) at an
// edge. So at a point ten nodes deform an element as a linear one whose corners c are displaced by
//
//   w_c = (4L_c − 1)·u_c + Σ_d 4L_d·u_cd        (d the other corners, cd the middle between)
//
// and what a law makes of four nodes, forces and tangent, goes back to the ten by the transpose.
// At point p L is kNear at corner p and kFar elsewhere, so that
//
//   w_c = kOwn·u_c + kEdge·Σ_d u_cd + kNearer·u_n(c, p)
//
// where n(c, p) is the middle between c and p, or the corner itself where they are the same.

// Of a node each.
template <class T, std::size_t N>
using OfNodes = std::array<Vector<T>, N>;
// The blocks (a, b) of N nodes with a <= b, a row's after the other.
template <class T, std::size_t N>
using BlocksOf = std::array<Tensor<T>, N*(N + 1) / 2>;

// One point, where nothing has to be done.
struct FourNodes {
  static constexpr std::size_t kNodes = 4;
  static constexpr std::size_t kPoints = 1;
  static constexpr bool kMeanDilatation = false;

  template <class T>
  class Displaced {
   public:
    explicit Displaced(const OfNodes<T, 4>& u) : u_(u) {}
    const OfNodes<T, 4>& at(std::size_t /*point*/) const { return u_; }

   private:
    OfNodes<T, 4> u_;
  };
  static constexpr Operations kDisplaced = {};
  static constexpr Operations kDisplacedAt = {};
  static constexpr Operations kForcesAt = kAddForces;
  static constexpr Operations kForces = {};
  static constexpr Operations kTangentsAt = {};
  static constexpr Operations kTangents = {};
};

namespace ten_nodes {

inline constexpr double kOwn = 4 * fem::kFar - 1;
inline constexpr double kEdge = 4 * fem::kFar;
inline constexpr double kNearer = 4 * (fem::kNear - fem::kFar);

// n(c, p), and for each corner the middles of its edges.
struct Tables {
  std::array<std::array<std::size_t, 4>, 4> beside{};
};
constexpr Tables tables() {
  Tables t;
  for (std::size_t c = 0; c < 4; ++c) t.beside[c][c] = c;
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t a = mesh::kTetEdges[k][0];
    const std::size_t b = mesh::kTetEdges[k][1];
    t.beside[a][b] = t.beside[b][a] = 4 + k;
  }
  return t;
}
inline constexpr Tables kTables = tables();

template <class T, std::size_t N>
void add(std::array<T, N>& sum, const std::array<T, N>& more) {
  for (std::size_t i = 0; i < N; ++i) sum[i] = sum[i] + more[i];
}

}  // namespace ten_nodes

struct TenNodes {
  static constexpr std::size_t kNodes = 10;
  static constexpr std::size_t kPoints = 4;
  static constexpr bool kMeanDilatation = false;

  // What the four corners have at each point, from what the ten nodes have: displacements or
  // velocities.
  template <class T>
  class Displaced {
   public:
    explicit Displaced(const OfNodes<T, 10>& u) {
      for (std::size_t a = 0; a < 10; ++a) {
        for (std::size_t i = 0; i < 3; ++i) near_[a][i] = T(ten_nodes::kNearer) * u[a][i];
      }
      for (std::size_t c = 0; c < 4; ++c) {
        const auto& beside = ten_nodes::kTables.beside[c];
        const std::size_t one = beside[(c + 1) % 4];
        const std::size_t two = beside[(c + 2) % 4];
        const std::size_t three = beside[(c + 3) % 4];
        for (std::size_t i = 0; i < 3; ++i) {
          everywhere_[c][i] = T(ten_nodes::kOwn) * u[c][i] +
                              T(ten_nodes::kEdge) * (u[one][i] + u[two][i] + u[three][i]);
        }
      }
    }
    OfNodes<T, 4> at(std::size_t point) const {
      OfNodes<T, 4> w = everywhere_;
      for (std::size_t c = 0; c < 4; ++c) {
        ten_nodes::add(w[c], near_[ten_nodes::kTables.beside[c][point]]);
      }
      return w;
    }

   private:
    OfNodes<T, 4> everywhere_;
    OfNodes<T, 10> near_;
  };
  static constexpr Operations kDisplaced = {.add_multiply = 10 * 3 + 4 * 3 * 5};
  static constexpr Operations kDisplacedAt = {.add_multiply = 4 * 3};

  // The forces of the ten nodes from those of the four corners at each point.
  template <class T>
  class Forces {
   public:
    void add(std::size_t point, const Tensor<T>& stress, const Gradients<T>& weighted) {
      OfNodes<T, 4> one{};
      add_forces(stress, weighted, {one[0].data(), one[1].data(), one[2].data(), one[3].data()});
      for (std::size_t c = 0; c < 4; ++c) {
        ten_nodes::add(everywhere_[c], one[c]);
        ten_nodes::add(near_[ten_nodes::kTables.beside[c][point]], one[c]);
      }
    }
    OfNodes<T, 10> of_nodes() const {
      OfNodes<T, 10> f;
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 4; ++c) {
          f[c][i] = T(ten_nodes::kOwn) * everywhere_[c][i] + T(ten_nodes::kNearer) * near_[c][i];
        }
        for (std::size_t k = 0; k < 6; ++k) {
          const auto& [a, b] = mesh::kTetEdges[k];
          f[4 + k][i] = T(ten_nodes::kEdge) * (everywhere_[a][i] + everywhere_[b][i]) +
                        T(ten_nodes::kNearer) * near_[4 + k][i];
        }
      }
      return f;
    }

   private:
    OfNodes<T, 4> everywhere_{};
    OfNodes<T, 10> near_{};
  };
  static constexpr Operations kForcesAt = kAddForces + Operations{.add_multiply = 2 * 4 * 3};
  static constexpr Operations kForces = {.add_multiply = 4 * 3 * 3 + 6 * 3 * 4};

  // The place of block (a, b), a <= b, in BlocksOf<T, 10>.
  static constexpr std::size_t pair(std::size_t a, std::size_t b) { return a * (19 - a) / 2 + b; }

  // The blocks of the ten nodes from those of the four corners at each point. With w = (A + S_p)·u,
  // S_p the choice of n(c, p), the sum of (A + S_p)ᵀ·K_p·(A + S_p) is Y + Yᵀ + Z with
  // Y = Aᵀ·(½·ΣK_p·A + ΣK_p·S_p) and Z = ΣS_pᵀ·K_p·S_p.
  template <class T>
  class Tangents {
   public:
    void add(std::size_t point, const Blocks<T>& k) {
      std::size_t block = 0;
      for (std::size_t c = 0; c < 4; ++c) {
        const std::size_t n = ten_nodes::kTables.beside[c][point];
        for (std::size_t d = c; d < 4; ++d) {
          const std::size_t m = ten_nodes::kTables.beside[d][point];
          const Tensor<T>& one = k[block];
          ten_nodes::add(everywhere_[block++], one);
          ten_nodes::add(mixed_[c][m], one);
          if (c != d) add_transposed(mixed_[d][n], one);
          if (n <= m) {
            ten_nodes::add(near_[pair(n, m)], one);
          } else {
            add_transposed(near_[pair(m, n)], one);
          }
        }
      }
    }
    BlocksOf<T, 10> of_nodes() const {
      std::array<std::array<Tensor<T>, 10>, 4> half{};  // ½·ΣK_p·A + ΣK_p·S_p
      for (std::size_t c = 0; c < 4; ++c) {
        std::array<Tensor<T>, 4> row{};
        for (std::size_t d = 0; d < 4; ++d) row[d] = everywhere(c, d);
        for (std::size_t b = 0; b < 10; ++b) {
          const Tensor<T> product = by_nodes(b, 0.5, [&](std::size_t d) { return row[d]; });
          half[c][b] = combine(T(1), product, T(ten_nodes::kNearer), mixed_[c][b]);
        }
      }
      std::array<std::array<Tensor<T>, 10>, 10> y{};
      for (std::size_t a = 0; a < 10; ++a) {
        for (std::size_t b = 0; b < 10; ++b) {
          y[a][b] = by_nodes(a, 1, [&](std::size_t c) { return half[c][b]; });
        }
      }
      BlocksOf<T, 10> result;
      for (std::size_t a = 0; a < 10; ++a) {
        for (std::size_t b = a; b < 10; ++b) {
          const Tensor<T>& near = near_[pair(a, b)];
          for (std::size_t i = 0; i < 9; ++i) {
            result[pair(a, b)][i] = y[a][b][i] + y[b][a][3 * (i % 3) + i / 3] +
                                    T(ten_nodes::kNearer * ten_nodes::kNearer) * near[i];
          }
        }
      }
      return result;
    }

   private:
    static void add_transposed(Tensor<T>& sum, const Tensor<T>& one) {
      for (std::size_t i = 0; i < 9; ++i) sum[i] = sum[i] + one[3 * (i % 3) + i / 3];
    }
    Tensor<T> everywhere(std::size_t c, std::size_t d) const {
      const auto at = [](std::size_t a, std::size_t b) { return a * (7 - a) / 2 + b; };
      if (c <= d) return everywhere_[at(c, d)];
      Tensor<T> turned{};
      transpose_into(turned, everywhere_[at(d, c)]);
      return turned;
    }
    static void transpose_into(Tensor<T>& to, const Tensor<T>& one) {
      for (std::size_t i = 0; i < 9; ++i) to[i] = one[3 * (i % 3) + i / 3];
    }
    // The row of Aᵀ of a node, times `scale`: its corner, or the two ends of its edge.
    template <class Of>
    static Tensor<T> by_nodes(std::size_t a, double scale, const Of& of) {
      Tensor<T> result;
      if (a < 4) {
        const Tensor<T> own = of(a);
        for (std::size_t i = 0; i < 9; ++i) result[i] = T(scale * ten_nodes::kOwn) * own[i];
        return result;
      }
      const Tensor<T> one = of(mesh::kTetEdges[a - 4][0]);
      const Tensor<T> other = of(mesh::kTetEdges[a - 4][1]);
      for (std::size_t i = 0; i < 9; ++i) {
        result[i] = T(scale * ten_nodes::kEdge) * (one[i] + other[i]);
      }
      return result;
    }

    Blocks<T> everywhere_{};                            // ΣK_p
    std::array<std::array<Tensor<T>, 10>, 4> mixed_{};  // ΣK_p·S_p
    BlocksOf<T, 10> near_{};                            // Z
  };
  static constexpr Operations kTangentsAt = {.add_multiply = (10 + 16 + 10) * 9};
  static constexpr Operations kTangents = {
      .add_multiply = 9.0 * (4 * (4 * (1 + 3) + 6 * (2 + 3)) + 10 * (4 * 1 + 6 * 2) + 55 * 3)};

  // Adds `weight`·b·bᵀ. Its products are the same to the last bit in both triangles.
  template <class T>
  static void add_outer(const T& weight, const OfNodes<T, 10>& b, BlocksOf<T, 10>& blocks) {
    std::size_t block = 0;
    for (std::size_t a = 0; a < 10; ++a) {
      for (std::size_t c = a; c < 10; ++c, ++block) {
        for (std::size_t i = 0; i < 9; ++i) {
          blocks[block][i] = blocks[block][i] + weight * (b[a][i / 3] * b[c][i % 3]);
        }
      }
    }
  }
  static constexpr Operations kOuter = {.add_multiply = 55 * 9 * 3};
};

// The same with models/tissue/mean_dilatation.h.
struct TenNodesOfMeanDilatation : TenNodes {
  static constexpr bool kMeanDilatation = true;
};

// Inertia's least share at the four corners of a point, over the point's part of an element's mass:
// the largest σ for which the mass matrix of fem::quadratic_mass_share() less σ·Σ_p W_pᵀ·W_p, W_p
// the map above but for a translation, has no negative eigenvalue.
double least_inertia_share(fem::Elements elements, fem::MassKind kind);

}  // namespace hvp::tissue
