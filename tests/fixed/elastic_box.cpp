#include "tests/fixed/elastic_box.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <map>

#include "models/index.h"

namespace hvp::fixed::test {

namespace {

using Block = Eigen::Matrix3d;

// Kuhn's subdivision: one tetrahedron for each order in which the axes are walked.
constexpr std::array<std::array<int, 3>, 6> kAxisOrders = {
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

}  // namespace

Body make_body(const Box& box) {
  const std::array<int, 3> cells = {box.cells_x, box.cells_y, box.cells_z};
  const auto index = [&](const std::array<int, 3>& p) {
    return (p[0] * (cells[1] + 1) + p[1]) * (cells[2] + 1) + p[2];
  };
  Random random(box.seed);
  std::vector<Eigen::Vector3d> position;
  for (int i = 0; i <= cells[0]; ++i) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int k = 0; k <= cells[2]; ++k) {
        Eigen::Vector3d p(i, j, k);
        const std::array<int, 3> at_cell = {i, j, k};
        for (int axis = 0; axis < 3; ++axis) {
          const double move = box.jitter * random.symmetric();
          if (at_cell[at(axis)] > 0 && at_cell[at(axis)] < cells[at(axis)]) p[axis] += move;
        }
        position.push_back(box.cell * p);
      }
    }
  }
  const double first_lame = box.young * box.poisson / ((1 + box.poisson) * (1 - 2 * box.poisson));
  const double shear = box.young / (2 * (1 + box.poisson));

  std::vector<std::map<int, Block>> rows(position.size());
  std::vector<double> mass(position.size(), 0.0);
  for (int i = 0; i < cells[0]; ++i) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int k = 0; k < cells[2]; ++k) {
        const Eigen::Vector3d centre = box.cell * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
        const double factor = box.contrast ? box.contrast(centre) : 1.0;
        for (const auto& order : kAxisOrders) {
          std::array<int, 3> corner = {i, j, k};
          std::array<int, 4> node = {index(corner), 0, 0, 0};
          for (int step = 0; step < 3; ++step) {
            ++corner[at(order[at(step)])];
            node[at(step + 1)] = index(corner);
          }
          Eigen::Matrix3d edges;
          for (int e = 0; e < 3; ++e)
            edges.col(e) = position[at(node[at(e + 1)])] - position[at(node[0])];
          const double volume = std::abs(edges.determinant()) / 6;
          const Eigen::Matrix3d inverse = edges.inverse();
          std::array<Eigen::Vector3d, 4> gradient;
          gradient[0].setZero();
          for (int e = 0; e < 3; ++e) {
            gradient[at(e + 1)] = inverse.row(e).transpose();
            gradient[0] -= gradient[at(e + 1)];
          }
          for (int p = 0; p < 4; ++p) {
            mass[at(node[at(p)])] += 1000 * volume / 4;
            for (int q = 0; q < 4; ++q) {
              Block& block =
                  rows[at(node[at(p)])].try_emplace(node[at(q)], Block::Zero()).first->second;
              const double dot = gradient[at(p)].dot(gradient[at(q)]);
              for (int a = 0; a < 3; ++a) {
                for (int b = 0; b < 3; ++b) {
                  // Products of two gradients first: K_pq and K_qpᵀ then have the same bits.
                  const double straight = gradient[at(p)][a] * gradient[at(q)][b];
                  const double crossed = gradient[at(p)][b] * gradient[at(q)][a];
                  block(a, b) += factor * volume *
                                 (first_lame * straight + shear * (crossed + (a == b ? dot : 0)));
                }
              }
            }
          }
        }
      }
    }
  }

  Body body;
  std::vector<int> number(position.size(), -1);
  const int held = (cells[1] + 1) * (cells[2] + 1);
  for (std::size_t n = at(held); n < position.size(); ++n) {
    number[n] = static_cast<int>(n) - held;
    body.position.push_back(position[n]);
    body.mass.push_back(mass[n]);
  }
  for (std::size_t n = at(held); n < position.size(); ++n) {
    for (const auto& [column, block] : rows[n]) {
      if (number[at(column)] < 0) continue;
      body.stiffness.column.push_back(number[at(column)]);
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) body.stiffness.value.push_back(block(a, b));
      }
    }
    body.stiffness.row_begin.push_back(static_cast<int>(body.stiffness.column.size()));
  }
  return body;
}

int Body::nearest(const Eigen::Vector3d& point) const {
  const auto closer = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - point).squaredNorm() < (b - point).squaredNorm();
  };
  return static_cast<int>(std::min_element(position.begin(), position.end(), closer) -
                          position.begin());
}

double condition_number(const sparse::BlockMatrix& matrix) {
  const Eigen::SparseMatrix<double> a = matrix.to_eigen();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(a);
  Random random(7);
  Eigen::VectorXd high(a.rows());
  for (auto& entry : high) entry = random.symmetric();
  Eigen::VectorXd low = high;
  double largest = 0;
  double smallest = 0;
  for (int i = 0; i < 200; ++i) {
    high.normalize();
    low.normalize();
    const Eigen::VectorXd up = a * high;
    const Eigen::VectorXd down = factor.solve(low);
    largest = high.dot(up);
    smallest = 1 / low.dot(down);
    high = up;
    low = down;
  }
  return largest / smallest;
}

sparse::BlockMatrix with_contact(const sparse::BlockMatrix& matrix, int node, double diagonal) {
  sparse::BlockMatrix result = matrix;
  for (int i = 0; i < result.block_rows(); ++i) {
    for (int k = result.row_begin[at(i)]; k < result.row_begin[at(i) + 1]; ++k) {
      const int column = result.column[at(k)];
      if (i != node && column != node) continue;
      std::fill_n(result.block(at(k)), 9, 0.0);
      if (i != column) continue;
      for (int e = 0; e < 9; e += 4) result.block(at(k))[e] = diagonal;
    }
  }
  return result;
}

Eigen::VectorXd contact_load(const sparse::BlockMatrix& matrix, int node, double diagonal,
                             const Eigen::Vector3d& displacement) {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(matrix.rows());
  for (int i = 0; i < matrix.block_rows(); ++i) {
    const std::ptrdiff_t k = matrix.find(i, node);
    if (k < 0 || i == node) continue;
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> block(
        matrix.block(static_cast<std::size_t>(k)));
    load.segment<3>(3 * i) = -block * displacement;
  }
  load.segment<3>(3 * node) = diagonal * displacement;
  return load;
}

}  // namespace hvp::fixed::test
