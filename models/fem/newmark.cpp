#include "models/fem/newmark.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/direct_solver.h"
#include "models/index.h"

namespace hvp::fem {

namespace {

// Row i of A·x for block row i.
void multiply_row(const sparse::BlockMatrix& a, std::span<const double> x, std::size_t row,
                  double* sum) {
  sum[0] = sum[1] = sum[2] = 0;
  for (int k = a.row_begin[row]; k < a.row_begin[row + 1]; ++k) {
    const double* block = a.block(at(k));
    const double* v = &x[3 * at(a.column[at(k)])];
    for (std::size_t r = 0; r < 3; ++r) {
      sum[r] += block[3 * r] * v[0] + block[3 * r + 1] * v[1] + block[3 * r + 2] * v[2];
    }
  }
}

// xᵀA·x
double quadratic_form(const sparse::BlockMatrix& a, std::span<const double> x) {
  double total = 0;
  for (std::size_t i = 0; i < at(a.block_rows()); ++i) {
    double row[3];
    multiply_row(a, x, i, row);
    total += x[3 * i] * row[0] + x[3 * i + 1] * row[1] + x[3 * i + 2] * row[2];
  }
  return total;
}

// M's diagonal, or empty where M has an entry off it.
std::vector<double> diagonal_if_lumped(const sparse::BlockMatrix& m) {
  std::vector<double> diagonal(at(m.rows()), 0.0);
  for (int i = 0; i < m.block_rows(); ++i) {
    for (int k = m.row_begin[at(i)]; k < m.row_begin[at(i) + 1]; ++k) {
      const double* block = m.block(at(k));
      for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) {
          if (m.column[at(k)] == i && r == c) {
            diagonal[3 * at(i) + r] = block[4 * r];
          } else if (block[3 * r + c] != 0) {
            return {};
          }
        }
      }
    }
  }
  return diagonal;
}

}  // namespace

Newmark::Newmark(const sparse::BlockMatrix& stiffness, const sparse::BlockMatrix& mass,
                 const Dynamics& dynamics, double time_step_s)
    : stiffness_(stiffness),
      mass_(mass),
      lumped_(diagonal_if_lumped(mass)),
      effective_(stiffness),
      dynamics_(dynamics),
      beta_(dynamics.parameters().beta),
      gamma_(dynamics.parameters().gamma),
      between_ends_(dynamics.scheme == Scheme::generalised_alpha),
      w_(between_ends_ ? 2 - dynamics.spectral_radius : 1),
      z_(between_ends_ ? 2 * dynamics.spectral_radius - 1 : 0),
      s_(between_ends_ ? dynamics.spectral_radius : 0),
      time_step_(time_step_s) {
  dynamics_.check();
  if (!(time_step_s > 0) || !std::isfinite(time_step_s)) {
    throw InputError(
        fmt::format("the time step is {} s; expected a finite value above 0", time_step_s));
  }
  if (mass.block_rows() != stiffness.block_rows()) {
    throw InputError(fmt::format("the mass matrix has {} nodes and the stiffness matrix {}",
                                 mass.block_rows(), stiffness.block_rows()));
  }
  const double stiffness_scale = 1 + velocity_weight() * dynamics_.rayleigh_stiffness;
  for (double& entry : effective_.value) entry *= stiffness_scale;
  add_inertia_to(effective_);
  for (std::vector<double>* state : {&u_, &v_, &a_, &v_tilde_, &a_tilde_, &inertia_}) {
    state->assign(at(stiffness_.rows()), 0.0);
  }
  if (between_ends_) elastic_ = u_;
}

double Newmark::inertia_weight() const {
  return w_ * acceleration_weight() + velocity_weight() * dynamics_.rayleigh_mass;
}

void Newmark::add_inertia_to(sparse::BlockMatrix& matrix) const {
  const double mass_scale = inertia_weight();
  for (int i = 0; i < mass_.block_rows(); ++i) {
    for (int k = mass_.row_begin[at(i)]; k < mass_.row_begin[at(i) + 1]; ++k) {
      const std::ptrdiff_t found = matrix.find(i, mass_.column[at(k)]);
      if (found < 0) {
        throw InputError(
            fmt::format("the mass matrix couples nodes {} and {}, which the "
                        "stiffness matrix does not",
                        i, mass_.column[at(k)]));
      }
      double* sum = matrix.block(static_cast<std::size_t>(found));
      for (std::size_t e = 0; e < 9; ++e) sum[e] += mass_scale * mass_.block(at(k))[e];
    }
  }
}

void Newmark::add_inertia(std::span<const double> u, std::span<double> q) const {
  const double weight = inertia_weight();
  if (!lumped_.empty()) {
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += weight * lumped_[i] * u[i];
    return;
  }
  for (std::size_t i = 0; i < at(mass_.block_rows()); ++i) {
    double row[3];
    multiply_row(mass_, u, i, row);
    for (std::size_t r = 0; r < 3; ++r) q[3 * i + r] += weight * row[r];
  }
}

Eigen::Vector3d Newmark::inertia(std::span<const double> u, int node) const {
  double row[3];
  multiply_row(mass_, u, at(node), row);
  return inertia_weight() * Eigen::Vector3d(row[0], row[1], row[2]);
}

double Newmark::inertia_flops() const {
  const auto rows = static_cast<double>(u_.size());
  return lumped_.empty() ? 18 * static_cast<double>(mass_.blocks()) + 2 * rows : 3 * rows;
}

void Newmark::predict() {
  const double beta = beta_;
  const double gamma = gamma_;
  const double dt = time_step_;
  const double a_of_u = -2 / (beta * dt * dt);
  const double a_of_v = -2 / (beta * dt);
  const double a_of_a = -(1 - beta) / beta;
  const double v_of_u = -2 * gamma / (beta * dt);
  const double v_of_v = 1 - 2 * gamma / beta;
  const double v_of_a = (1 - gamma / beta) * dt;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    a_tilde_[i] = a_of_u * u_[i] + a_of_v * v_[i] + a_of_a * a_[i];
    v_tilde_[i] = v_of_u * u_[i] + v_of_v * v_[i] + v_of_a * a_[i];
    inertia_[i] = dynamics_.rayleigh_mass * v_tilde_[i] + a_tilde_[i];
  }
  if (!between_ends_) return;
  for (std::size_t i = 0; i < u_.size(); ++i) {
    const double v = v_tilde_[i] + s_ * v_[i];
    inertia_[i] = dynamics_.rayleigh_mass * v + w_ * a_tilde_[i] + z_ * a_[i];
    elastic_[i] = dynamics_.rayleigh_stiffness * v + s_ * u_[i];
  }
}

void Newmark::subtract_inertia(std::span<double> f_hat) const {
  if (!lumped_.empty()) {
    for (std::size_t i = 0; i < f_hat.size(); ++i) f_hat[i] -= lumped_[i] * inertia_[i];
    return;
  }
  for (std::size_t i = 0; i < at(mass_.block_rows()); ++i) {
    double inertial[3];
    multiply_row(mass_, inertia_, i, inertial);
    for (std::size_t r = 0; r < 3; ++r) f_hat[3 * i + r] -= inertial[r];
  }
}

void Newmark::rhs(std::span<const double> f, std::span<const double> q,
                  std::span<double> f_hat) const {
  assert(f.size() == u_.size() && f_hat.size() == u_.size());
  assert(!between_ends_ || q.size() == u_.size());
  if (between_ends_) {
    for (std::size_t i = 0; i < f_hat.size(); ++i) f_hat[i] = f[i] + s_ * (f[i] - q[i]);
  } else {
    std::ranges::copy(f, f_hat.begin());
  }
  subtract_inertia(f_hat);
}

void Newmark::rhs(std::span<const double> f, std::span<double> f_hat) {
  assert(f.size() == u_.size() && f_hat.size() == u_.size());
  if (between_ends_) {
    stiffness_.multiply(elastic_, f_hat);
    for (std::size_t i = 0; i < f_hat.size(); ++i) f_hat[i] = f[i] + s_ * f[i] - f_hat[i];
    subtract_inertia(f_hat);
    return;
  }
  const double damping = dynamics_.rayleigh_stiffness;
  if (damping != 0) {
    stiffness_.multiply(v_tilde_, f_hat);  // f̂ has C·ṽ / damping first
  } else {
    std::fill(f_hat.begin(), f_hat.end(), 0.0);
  }
  if (lumped_.empty()) {
    for (std::size_t i = 0; i < at(mass_.block_rows()); ++i) {
      double inertial[3];
      multiply_row(mass_, inertia_, i, inertial);
      for (std::size_t r = 0; r < 3; ++r) {
        f_hat[3 * i + r] = f[3 * i + r] - damping * f_hat[3 * i + r] - inertial[r];
      }
    }
    return;
  }
  for (std::size_t i = 0; i < f_hat.size(); ++i) {
    f_hat[i] = f[i] - damping * f_hat[i] - lumped_[i] * inertia_[i];
  }
}

void Newmark::hold(const Hold& hold, std::span<double> f_hat) {
  if (hold.elapsed_s == 0) return;
  const double a_of_u = acceleration_weight();
  const double v_of_u = velocity_weight();
  for (std::size_t i = 0; i < hold.nodes.size(); ++i) {
    const int node = hold.nodes[i];
    const Eigen::Vector3d& u = hold.displacement[i];
    Eigen::Vector3d elastic;   // what K multiplies
    Eigen::Vector3d inertial;  // what M multiplies
    for (int r = 0; r < 3; ++r) {
      const std::size_t dof = 3 * at(node) + at(r);
      const double q = (u[r] - u_[dof]) / hold.elapsed_s - (v_tilde_[dof] + v_of_u * u[r]);
      const double p = -(a_tilde_[dof] + a_of_u * u[r]);
      v_tilde_[dof] += q;
      a_tilde_[dof] += p;
      elastic[r] = dynamics_.rayleigh_stiffness * q;
      inertial[r] = dynamics_.rayleigh_mass * q + w_ * p;
    }
    if (dynamics_.rayleigh_stiffness != 0) stiffness_.subtract_column(node, elastic, f_hat);
    mass_.subtract_column(node, inertial, f_hat);
  }
}

void Newmark::update(std::span<const double> u_next) {
  assert(u_next.size() == u_.size());
  const double a_of_u = acceleration_weight();
  const double v_of_u = velocity_weight();
  for (std::size_t i = 0; i < u_.size(); ++i) {
    u_[i] = u_next[i];
    a_[i] = a_tilde_[i] + a_of_u * u_next[i];
    v_[i] = v_tilde_[i] + v_of_u * u_next[i];
  }
}

void Newmark::set_state(std::span<const double> u, std::span<const double> v,
                        std::span<const double> a) {
  assert(u.size() == u_.size() && v.size() == v_.size() && a.size() == a_.size());
  std::copy(u.begin(), u.end(), u_.begin());
  std::copy(v.begin(), v.end(), v_.begin());
  std::copy(a.begin(), a.end(), a_.begin());
}

// Σ over a node's row of M·(ü + α·u̇).
Eigen::Vector3d Newmark::end_inertia(std::span<const double> u, int node) const {
  const double weight = acceleration_weight() + dynamics_.rayleigh_mass * velocity_weight();
  const auto moved = [&](std::size_t dof) {
    return a_tilde_[dof] + dynamics_.rayleigh_mass * v_tilde_[dof] + weight * u[dof];
  };
  const auto row = at(node);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  if (!lumped_.empty()) {
    for (std::size_t r = 0; r < 3; ++r) {
      force[static_cast<int>(r)] = lumped_[3 * row + r] * moved(3 * row + r);
    }
    return force;
  }
  for (int k = mass_.row_begin[row]; k < mass_.row_begin[row + 1]; ++k) {
    const double* block = mass_.block(at(k));
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = moved(3 * at(mass_.column[at(k)]) + c);
      for (std::size_t r = 0; r < 3; ++r) force[static_cast<int>(r)] += block[3 * r + c] * x;
    }
  }
  return force;
}

Eigen::Vector3d Newmark::end_force(std::span<const double> u, std::span<const double> f,
                                   int node) const {
  const double damping = dynamics_.rayleigh_stiffness;
  const double weight = 1 + damping * velocity_weight();
  const auto row = at(node);
  Eigen::Vector3d force = end_inertia(u, node);
  for (int k = stiffness_.row_begin[row]; k < stiffness_.row_begin[row + 1]; ++k) {
    const double* block = stiffness_.block(at(k));
    const std::size_t other = 3 * at(stiffness_.column[at(k)]);
    for (std::size_t c = 0; c < 3; ++c) {
      const double x = weight * u[other + c] + damping * v_tilde_[other + c];
      for (std::size_t r = 0; r < 3; ++r) force[static_cast<int>(r)] += block[3 * r + c] * x;
    }
  }
  for (std::size_t r = 0; r < 3; ++r) force[static_cast<int>(r)] -= f[3 * row + r];
  return force;
}

double Newmark::end_inertia_flops(std::span<const int> nodes) const {
  // Four for what a component moves; a block's product and sum, or that of a diagonal.
  double flops = 0;
  for (const int node : nodes) {
    const auto row = at(node);
    flops +=
        lumped_.empty() ? 30.0 * (mass_.row_begin[row + 1] - mass_.row_begin[row]) : 3.0 * (4 + 1);
  }
  return flops;
}

double Newmark::end_force_flops(std::span<const int> nodes) const {
  double flops = end_inertia_flops(nodes);
  const double block = dynamics_.rayleigh_stiffness != 0 ? 18 + 9 : 18;
  for (const int node : nodes) {
    const auto row = at(node);
    flops += block * (stiffness_.row_begin[row + 1] - stiffness_.row_begin[row]) + 3;
  }
  return flops;
}

double Newmark::energy() const {
  return 0.5 * quadratic_form(mass_, v_) + 0.5 * quadratic_form(stiffness_, u_);
}

// ã and ṽ, and what M multiplies.
double Newmark::predict_flops() const {
  return (between_ends_ ? 10.0 + 7 : 12.0) * static_cast<double>(u_.size());
}

double Newmark::rhs_flops_of_forces() const {
  const auto rows = static_cast<double>(u_.size());
  const double start = between_ends_ ? 3 * rows : 0;
  return start + (lumped_.empty() ? 18 * static_cast<double>(mass_.blocks()) + rows : 2 * rows);
}

double Newmark::rhs_flops() const {
  const auto rows = static_cast<double>(u_.size());
  double flops = 0;
  if (between_ends_) {
    // What K multiplies, the product, (1 + s)·f.
    flops += 3 * rows + 18 * static_cast<double>(stiffness_.blocks()) + 3 * rows;
    return flops + (lumped_.empty() ? 18 * static_cast<double>(mass_.blocks()) + rows : 2 * rows);
  }
  if (dynamics_.rayleigh_stiffness != 0) {
    flops += 18 * static_cast<double>(stiffness_.blocks()) + 2 * rows;
  }
  flops += lumped_.empty() ? 18 * static_cast<double>(mass_.blocks()) + rows : 2 * rows;
  return flops;
}

double Newmark::update_flops() const { return 4.0 * static_cast<double>(u_.size()); }

double Newmark::hold_flops(const Hold& hold) const {
  if (hold.elapsed_s == 0) return 0;
  double flops = 0;
  for (const int node : hold.nodes) {
    const auto row = at(node);
    if (dynamics_.rayleigh_stiffness != 0) {
      flops += 18.0 * (stiffness_.row_begin[row + 1] - stiffness_.row_begin[row]);
    }
    // A lumped mass has nothing but the diagonal of the diagonal block.
    flops += lumped_.empty() ? 18.0 * (mass_.row_begin[row + 1] - mass_.row_begin[row]) : 6.0;
    // p, q, what K and M multiply, ã and ṽ: for each of the three components.
    flops += 3.0 * 12;
  }
  return flops;
}

std::vector<double> consistent_acceleration(const sparse::BlockMatrix& stiffness,
                                            const sparse::BlockMatrix& mass,
                                            const Dynamics& dynamics, std::span<const double> u,
                                            std::span<const double> v, std::span<const double> f) {
  const std::size_t rows = u.size();
  std::vector<double> product(rows);
  std::vector<double> result(rows);
  std::vector<double> force(f.begin(), f.end());
  stiffness.multiply(u, product);
  for (std::size_t i = 0; i < rows; ++i) force[i] -= product[i];
  stiffness.multiply(v, product);
  for (std::size_t i = 0; i < rows; ++i) force[i] -= dynamics.rayleigh_stiffness * product[i];
  mass.multiply(v, product);
  for (std::size_t i = 0; i < rows; ++i) force[i] -= dynamics.rayleigh_mass * product[i];
  DirectSolver(mass).solve(force, result);
  return result;
}

}  // namespace hvp::fem
