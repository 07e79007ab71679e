#include "models/fem/quadratic_element.h"

#include "models/index.h"

namespace hvp::fem {

const std::vector<std::pair<std::string_view, Elements>>& elements_names() {
  static const std::vector<std::pair<std::string_view, Elements>> names = {
      {"linear", Elements::linear},
      {"quadratic", Elements::quadratic},
      {"quadratic-mean-dilatation", Elements::mean_dilatation}};
  return names;
}

std::array<double, kTenNodes> quadratic_shape(const Barycentric& l) {
  std::array<double, kTenNodes> n{};
  for (std::size_t a = 0; a < 4; ++a) n[a] = l[a] * (2 * l[a] - 1);
  for (std::size_t k = 0; k < 6; ++k) {
    n[4 + k] = 4 * l[mesh::kTetEdges[k][0]] * l[mesh::kTetEdges[k][1]];
  }
  return n;
}

std::array<Eigen::Vector3d, kTenNodes> quadratic_gradients(const ElementGeometry& geometry,
                                                           const Barycentric& l) {
  const std::array<Eigen::Vector3d, 4>& g = geometry.gradient;
  std::array<Eigen::Vector3d, kTenNodes> result;
  for (std::size_t a = 0; a < 4; ++a) result[a] = (4 * l[a] - 1) * g[a];
  for (std::size_t k = 0; k < 6; ++k) {
    const auto& [a, b] = mesh::kTetEdges[k];
    result[4 + k] = 4 * (l[a] * g[b] + l[b] * g[a]);
  }
  return result;
}

std::array<Eigen::Vector3d, kTenNodes> mean_gradients(const ElementGeometry& geometry) {
  return quadratic_gradients(geometry, {0.25, 0.25, 0.25, 0.25});
}

Barycentric integration_point(std::size_t point) {
  Barycentric l = {kFar, kFar, kFar, kFar};
  l[point] = kNear;
  return l;
}

namespace {

// Adds weight·(λ·g_a g_bᵀ + μ·g_b g_aᵀ + μ·(g_a·g_b)·I) for all pairs of nodes. Block (b, a) has
// the products of block (a, b) in the same order.
void add_points(const std::array<Eigen::Vector3d, kTenNodes>& g, double lambda, double mu,
                TenNodeMatrix& k) {
  for (std::size_t a = 0; a < kTenNodes; ++a) {
    for (std::size_t b = 0; b < kTenNodes; ++b) {
      const double shear = mu * (g[a].x() * g[b].x() + g[a].y() * g[b].y() + g[a].z() * g[b].z());
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          k(3 * static_cast<int>(a) + i, 3 * static_cast<int>(b) + j) +=
              lambda * (g[a][i] * g[b][j]) + mu * (g[a][j] * g[b][i]) + (i == j ? shear : 0.0);
        }
      }
    }
  }
}

}  // namespace

TenNodeMatrix quadratic_stiffness(const ElementGeometry& geometry, const Material& material,
                                  Elements elements) {
  TenNodeMatrix k = TenNodeMatrix::Zero();
  const double volume = geometry.volume();
  const double lambda = material.lame_lambda() * volume;
  const double mu = material.lame_mu() * volume;
  const bool mean = elements == Elements::mean_dilatation;
  for (std::size_t point = 0; point < 4; ++point) {
    add_points(quadratic_gradients(geometry, integration_point(point)), mean ? 0.0 : lambda / 4,
               mu / 4, k);
  }
  if (mean) add_points(mean_gradients(geometry), lambda, 0.0, k);
  return k;
}

namespace {

bool ends_at(std::size_t edge, std::size_t corner) {
  return mesh::kTetEdges[edge][0] == corner || mesh::kTetEdges[edge][1] == corner;
}

// 420·∫N_a·N_b dV/V, from ∫L_0^i·L_1^j·L_2^k·L_3^l dV = 6V·i!j!k!l!/(i+j+k+l+3)!.
double mass_in_420ths(std::size_t a, std::size_t b) {
  if (a < 4 && b < 4) return a == b ? 6 : 1;
  if (a < 4) return ends_at(b - 4, a) ? -4 : -6;
  if (b < 4) return mass_in_420ths(b, a);
  if (a == b) return 32;
  const auto& ends = mesh::kTetEdges[b - 4];
  return ends_at(a - 4, ends[0]) || ends_at(a - 4, ends[1]) ? 16 : 8;
}

}  // namespace

double quadratic_mass_share(MassKind kind, std::size_t a, std::size_t b) {
  if (kind == MassKind::consistent) return mass_in_420ths(a, b) / 420;
  constexpr double kTrace = 4 * 6 + 6 * 32;
  return a == b ? mass_in_420ths(a, a) / kTrace : 0;
}

double quadratic_volume_share(std::size_t a) { return a < 4 ? -1.0 / 20 : 1.0 / 5; }

std::array<double, 6> quadratic_face_shares(std::size_t triangle) {
  // Barycentric coordinates of the face's six nodes, twice, and the triangles between them.
  static constexpr std::array<std::array<int, 3>, 6> kNode{
      {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}}};
  static constexpr std::array<std::array<std::size_t, 3>, 4> kTriangle{
      {{0, 3, 5}, {1, 4, 3}, {2, 5, 4}, {3, 4, 5}}};
  std::array<double, 6> share{};
  // The middles of a triangle's sides, each a third of its area, integrate degree two exactly.
  for (std::size_t side = 0; side < 3; ++side) {
    const auto& one = kNode[kTriangle[triangle][side]];
    const auto& other = kNode[kTriangle[triangle][(side + 1) % 3]];
    std::array<double, 3> l{};
    for (std::size_t i = 0; i < 3; ++i) l[i] = (one[i] + other[i]) / 4.0;
    for (std::size_t i = 0; i < 3; ++i) {
      share[i] += l[i] * (2 * l[i] - 1) / 3;
      share[3 + i] += 4 * l[i] * l[(i + 1) % 3] / 3;
    }
  }
  return share;
}

std::array<int, 6> quadratic_face(const mesh::TetMesh& mesh, int triangle) {
  const std::size_t first = 4 * (at(triangle) / 4);
  const std::array<int, 3>& middle = mesh.boundary[first + 3];
  return {mesh.boundary[first][0],
          mesh.boundary[first + 1][0],
          mesh.boundary[first + 2][0],
          middle[0],
          middle[1],
          middle[2]};
}

std::array<Eigen::Matrix3d, 4> corner_gradients(const std::array<int, 10>& nodes,
                                                const std::array<Eigen::Vector3d, 4>& g,
                                                std::span<const double> u_full) {
  const auto u = [&](std::size_t a) {
    return Eigen::Map<const Eigen::Vector3d>(&u_full[3 * at(nodes[a])]);
  };
  // At corner c ∇N_a is 3·g_c where a = c, else −g_a; ∇N_cb is 4·g_b, and zero on other edges.
  Eigen::Matrix3d common = Eigen::Matrix3d::Zero();
  for (std::size_t a = 0; a < 4; ++a) common -= u(a) * g[a].transpose();
  std::array<Eigen::Matrix3d, 4> result;
  for (std::size_t c = 0; c < 4; ++c) result[c] = common + 4 * u(c) * g[c].transpose();
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t a = mesh::kTetEdges[k][0];
    const std::size_t b = mesh::kTetEdges[k][1];
    result[a] += 4 * u(4 + k) * g[b].transpose();
    result[b] += 4 * u(4 + k) * g[a].transpose();
  }
  return result;
}

}  // namespace hvp::fem
