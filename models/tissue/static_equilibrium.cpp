#include "models/tissue/static_equilibrium.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "models/fem/direct_solver.h"
#include "models/index.h"

namespace hvp::tissue {
namespace {

// Armijo's share of the fall that the slope promises, as it is commonly chosen (Nocedal, Wright:
// Numerical Optimization, 2006, §3.1).
constexpr double kShareOfFall = 1e-4;
// A step may take this share of the smallest det F, so that Newton does not jump to the edge of
// where the law is defined. Chosen.
constexpr double kLeastOfDeterminant = 0.1;
constexpr int kMostHalvings = 40;

double largest_component(std::span<const double> v) {
  double largest = 0;
  for (const double x : v) largest = std::max(largest, std::abs(x));
  return largest;
}

bool finite(std::span<const double> v) {
  return std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

StaticEquilibrium::StaticEquilibrium(const ElasticBody& body, Settings settings)
    : body_(body),
      settings_(settings),
      rounding_n_(rounding_of_forces(body.body())),
      is_free_(at(body.body().active_nodes())),
      tangent_(body.body().stiffness()),
      u_full_(3 * body.body().mesh().nodes.size()),
      internal_(u_full_.size()),
      residual_(body.body().load().size()),
      direction_(residual_.size()),
      right_(residual_.size()) {}

void StaticEquilibrium::choose_free_nodes(const fem::Hold& hold) {
  const fem::Body& body = body_.body();
  for (int a = 0; a < body.active_nodes(); ++a) {
    is_free_[at(a)] = body.held(body.node_of_active()[at(a)]) ? 0 : 1;
  }
  for (const int node : hold.nodes) is_free_[at(node)] = 0;
  free_.clear();
  for (int a = 0; a < body.active_nodes(); ++a) {
    if (is_free_[at(a)]) free_.push_back(a);
  }
}

StaticEquilibrium::Point StaticEquilibrium::look_at(std::span<const double> u,
                                                    std::span<const double> load) {
  const fem::Body& body = body_.body();
  body.expand(u, u_full_);
  Point point;
  point.deformation = body_.internal_forces(u_full_, internal_);
  if (!point.deformation.defined()) return point;
  point.deformation.operations += body_.energy(u_full_, point.energy).operations;
  point.potential = point.energy;
  point.force = largest_component(internal_);
  for (int a = 0; a < body.active_nodes(); ++a) {
    const std::size_t node = at(body.node_of_active()[at(a)]);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t k = 3 * at(a) + i;
      residual_[k] = is_free_[at(a)] ? load[k] - internal_[3 * node + i] : 0.0;
      point.potential -= is_free_[at(a)] ? load[k] * u[k] : 0.0;
      if (is_free_[at(a)]) point.force = std::max(point.force, std::abs(load[k]));
    }
  }
  point.residual = largest_component(residual_);
  return point;
}

// K·d = r over the free nodes with d = gap at the prescribed ones. False if K is singular, not
// finite, or indefinite where it has to be definite.
bool StaticEquilibrium::solve_with(const sparse::BlockMatrix& k, const fem::Hold& hold,
                                   bool need_definite) {
  if (!finite(k.value)) return false;
  const sparse::BlockMatrix of_free = k.submatrix(free_);
  const fem::DirectSolver solver(of_free);
  if (solver.singular() || (need_definite && !solver.positive_definite())) return false;
  right_ = residual_;
  for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
    k.subtract_column(hold.nodes[n], gap_[n], right_);
  }
  std::vector<double> solution(3 * free_.size());
  for (std::size_t n = 0; n < free_.size(); ++n) {
    std::copy_n(&right_[3 * at(free_[n])], 3, &solution[3 * n]);
  }
  solver.solve(solution, solution);
  std::fill(direction_.begin(), direction_.end(), 0.0);
  for (std::size_t n = 0; n < free_.size(); ++n) {
    std::copy_n(&solution[3 * n], 3, &direction_[3 * at(free_[n])]);
  }
  for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
    std::copy_n(gap_[n].data(), 3, &direction_[3 * at(hold.nodes[n])]);
  }
  return true;
}

Equilibrium StaticEquilibrium::solve(std::span<const double> load, const fem::Hold& hold,
                                     std::span<double> u) {
  assert(load.size() == residual_.size() && u.size() == load.size());
  choose_free_nodes(hold);
  gap_.resize(hold.nodes.size());
  bool reached = true;  // the prescribed displacements
  for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
    const double* now = &u[3 * at(hold.nodes[n])];
    gap_[n] = hold.displacement[n] - Eigen::Vector3d(now[0], now[1], now[2]);
    reached = reached && gap_[n].isZero(0);
  }

  Equilibrium result;
  Point here = look_at(u, load);
  std::vector<double> next(u.size());
  const auto end = [&](Equilibrium::End how) {
    result.end = how;
    result.energy_j = here.energy;
    result.deformation = here.deformation;
    return result;
  };
  if (!here.deformation.defined()) return end(Equilibrium::End::undefined_start);
  while (true) {
    result.residual_n.push_back(here.residual);
    if (reached && here.residual <= std::max(settings_.tolerance * here.force, rounding_n_)) {
      return end(Equilibrium::End::converged);
    }
    if (result.steps() == settings_.most_steps) return end(Equilibrium::End::too_many_steps);
    body_.body().expand(u, u_full_);
    const Deformation found = body_.tangent(u_full_, Linearisation::exact, tangent_);
    if (!found.defined() || !solve_with(tangent_, hold, true)) {
      ++result.at_rest;
      if (!solve_with(body_.body().stiffness(), hold, false)) {
        return end(Equilibrium::End::singular);
      }
    }

    double slope = 0;
    for (std::size_t i = 0; i < u.size(); ++i) slope -= residual_[i] * direction_[i];
    const Point before = here;
    double share = 1;
    for (int halving = 0;; ++halving, share *= 0.5) {
      if (halving > kMostHalvings) {
        here = look_at(u, load);
        return end(Equilibrium::End::no_step);
      }
      for (std::size_t i = 0; i < u.size(); ++i) next[i] = u[i] + share * direction_[i];
      if (share == 1) {
        for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
          std::copy_n(hold.displacement[n].data(), 3, &next[3 * at(hold.nodes[n])]);
        }
      }
      here = look_at(next, load);
      if (!here.deformation.defined()) continue;
      if (body_.needs_positive_determinant() &&
          here.deformation.smallest_determinant <
              kLeastOfDeterminant * before.deformation.smallest_determinant) {
        continue;
      }
      // While prescribed nodes move, the potential may rise.
      if (!reached || here.residual < before.residual ||
          here.potential <= before.potential + kShareOfFall * share * slope) {
        break;
      }
    }
    if (share < 1) ++result.shortened;
    std::copy(next.begin(), next.end(), u.begin());
    reached = reached || share == 1;
    for (Eigen::Vector3d& gap : gap_) gap *= reached ? 0 : 1 - share;
  }
}

}  // namespace hvp::tissue
