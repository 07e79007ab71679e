#include "models/fit/interval.h"

#include <algorithm>
#include <cmath>

namespace hvp::fit {

namespace {

constexpr double kLinear = 0.2;  // of the rise
constexpr int kMostProfilePoints = 8;
constexpr double kNear = 0.02;  // of the root of the rise

}  // namespace

Intervals::Intervals(Search& search, const Coordinates& coordinates, const Linear& linear,
                     const Uncertainty& uncertainty, const Optimum& optimum)
    : search_(search),
      coordinates_(coordinates),
      linear_(linear),
      uncertainty_(uncertainty),
      optimum_(optimum) {}

double Intervals::limited(std::size_t coordinate, double z) const {
  return std::clamp(z, coordinates_.low(coordinate), coordinates_.high(coordinate));
}

// Where a linear problem's others would be with this coordinate so far off.
Point Intervals::moved(std::size_t coordinate, double step) const {
  const auto k = static_cast<Eigen::Index>(coordinate);
  const Eigen::VectorXd steps = uncertainty_.unit.col(k) * (step / uncertainty_.unit(k, k));
  Point point = optimum_.at;
  for (std::size_t j = 0; j < coordinates_.size(); ++j) {
    point.z[j] = limited(j, point.z[j] + steps[static_cast<Eigen::Index>(j)]);
  }
  std::size_t fitted = 0;
  for (std::size_t s = 0; s < point.own.size(); ++s) {
    if (search_.range().rows[s] == 0) continue;
    const Eigen::VectorXd own = linear_.follows[fitted++] * steps;
    for (std::size_t i = 0; i < point.own[s].size(); ++i) {
      point.own[s][i] += own[static_cast<Eigen::Index>(i)];
    }
  }
  return point;
}

Interval Intervals::plain(std::size_t coordinate) const {
  const double z = optimum_.at.z[coordinate];
  const double step = uncertainty_.t * uncertainty_.deviation(coordinate);
  return {limited(coordinate, z - step), limited(coordinate, z + step)};
}

Interval Intervals::of(std::size_t coordinate) {
  const auto k = static_cast<Eigen::Index>(coordinate);
  const double z = optimum_.at.z[coordinate];
  const double step = uncertainty_.t * uncertainty_.deviation(coordinate);
  if (!(step > 0) || !std::isfinite(step)) return {z, z};
  const double expected = linear_.slope * step * step / uncertainty_.unit(k, k);
  const auto ratio = [&](double by) {
    const double at = limited(coordinate, z + by) - z;
    if (at == 0) return 1.0;
    const std::optional<double> sum = search_.sum(moved(coordinate, at));
    return sum ? (*sum - optimum_.sum) / (expected * (at / step) * (at / step)) : 1e6;
  };
  const double below = ratio(-step);
  const double above = ratio(step);
  if (std::abs(below - 1) <= kLinear && std::abs(above - 1) <= kLinear) {
    return {limited(coordinate, z - step), limited(coordinate, z + step)};
  }
  return {end(coordinate, -step, below), end(coordinate, step, above), true};
}

// The root of √rise − √expected, by secants from z, where the rise is zero.
double Intervals::end(std::size_t coordinate, double step, double ratio) {
  const auto k = static_cast<Eigen::Index>(coordinate);
  const double z = optimum_.at.z[coordinate];
  const double wanted = std::sqrt(linear_.slope / uncertainty_.unit(k, k)) * std::abs(step);
  double inside = 0;  // of the step: the rise is less than wanted
  double inside_root = 0;
  double outside = 0;  // likewise, more; 0: none found
  double outside_root = 0;
  double at = 1 / std::sqrt(std::clamp(ratio, 0.25, 4.0));
  Point start = optimum_.at;
  for (int i = 0; i < kMostProfilePoints; ++i) {
    const double place = limited(coordinate, z + at * step);
    const bool at_bound = place != z + at * step;
    at = (place - z) / step;
    if (at <= inside) return place;  // the bound
    start.z[coordinate] = place;
    const Optimum least = search_.with(coordinate, start);
    if (least.interrupted) return place;
    const double root =
        least.found ? std::sqrt(std::max(0.0, least.sum - optimum_.sum)) : 10 * wanted;
    if (least.found) start = least.at;
    if (std::abs(root - wanted) <= kNear * wanted) return place;
    if (root < wanted) {
      if (at_bound) return place;
      inside = at;
      inside_root = root;
    } else {
      outside = at;
      outside_root = root;
    }
    if (outside == 0) {
      at = root > 0.1 * wanted ? std::min(2 * at, at * wanted / root * 1.05) : 2 * at;
    } else {
      const double share = (wanted - inside_root) / (outside_root - inside_root);
      at = inside + (outside - inside) * std::clamp(share, 0.1, 0.9);
    }
  }
  return limited(coordinate, z + (outside > 0 ? at : inside) * step);
}

}  // namespace hvp::fit
