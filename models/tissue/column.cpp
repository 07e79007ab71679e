#include "models/tissue/column.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::tissue {
namespace {

void check_above_zero(const char* key, double value, const char* unit) {
  if (value > 0 && std::isfinite(value)) return;
  throw InputError(key, fmt::format("found {} {}; expected a finite value above 0", value, unit));
}

}  // namespace

Column::Column(const Law& law, double area_m2, double height_m)
    : law_(law), area_m2_(area_m2), height_m_(height_m) {
  check_above_zero("area", area_m2, "m²");
  check_above_zero("height", height_m, "m");
}

// The axial P of a stretch with the sides free of stress. The lateral stretch is found by halving:
// the sides' stress grows with it, and where the law is not defined it is too far from the one that
// keeps the volume.
std::optional<double> Column::stress(double stretch) const {
  const double keeps_volume = 1 / std::sqrt(stretch);
  double low = 0.5 * std::min(1.0, keeps_volume);
  double high = 2 * std::max(1.0, keeps_volume);
  const auto at = [&](double side) {
    return law_.stress(Eigen::Vector3d(stretch, side, side).asDiagonal());
  };
  while (true) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    const std::optional<Eigen::Matrix3d> p = at(middle);
    const bool too_wide = p ? (*p)(1, 1) > 0 : middle > keeps_volume;
    (too_wide ? high : low) = middle;
  }
  const std::optional<Eigen::Matrix3d> p = at(low);
  if (!p) return std::nullopt;
  return (*p)(0, 0);
}

std::optional<double> Column::force(double depth_m) const {
  if (depth_m <= 0) return 0;
  if (!(depth_m < height_m_)) return std::nullopt;
  const std::optional<double> p = stress(1 - depth_m / height_m_);
  if (!p) return std::nullopt;
  return -area_m2_ * *p;
}

std::optional<std::vector<double>> forces_over_time(const Column& column, const PronySeries& series,
                                                    std::span<const double> depth) {
  PronyForces<double> memory(series, 1);
  std::vector<double> forces;
  forces.reserve(depth.size());
  for (const double d : depth) {
    const std::optional<double> elastic = column.force(d);
    if (!elastic) return std::nullopt;
    if (forces.empty()) memory.rest({&*elastic, 1});
    double force = 0;
    memory.forces({&*elastic, 1}, {&force, 1});
    memory.commit({&*elastic, 1});
    forces.push_back(force);
  }
  return forces;
}

}  // namespace hvp::tissue
