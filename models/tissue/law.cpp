#include "models/tissue/law.h"

#include <algorithm>
#include <cstddef>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::tissue {
namespace {

Law::Form form_of(LawKind kind, const fem::Material& material, const Parameters& parameters) {
  material.check();
  parameters.check();
  const double lambda = material.lame_lambda();
  const double mu = material.lame_mu();
  switch (kind) {
    case LawKind::linear:
      break;
    case LawKind::corotational:
      return Corotational{lambda, mu};
    case LawKind::st_venant_kirchhoff:
      return StVenantKirchhoff{lambda, mu};
    case LawKind::neo_hookean_log:
      return NeoHookeanLog{lambda, mu};
    case LawKind::neo_hookean_isochoric:
      return NeoHookeanIsochoric{lambda + 2 * mu / 3, mu};
    case LawKind::fung:
      return Fung{lambda + 2 * mu / 3, mu, std::max(parameters.exponent, Fung::kLeastB)};
  }
  return Linear{lambda, mu};
}

Tensor<double> by_rows(const Eigen::Matrix3d& f) {
  return {f(0, 0), f(0, 1), f(0, 2), f(1, 0), f(1, 1), f(1, 2), f(2, 0), f(2, 1), f(2, 2)};
}

Eigen::Matrix3d matrix(const Tensor<double>& rows) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

}  // namespace

const std::vector<std::pair<std::string_view, LawKind>>& law_names() {
  static const std::vector<std::pair<std::string_view, LawKind>> names = {
      {"linear", LawKind::linear},
      {"corotational", LawKind::corotational},
      {"st-venant-kirchhoff", LawKind::st_venant_kirchhoff},
      {"neo-hookean-log", LawKind::neo_hookean_log},
      {"neo-hookean-isochoric", LawKind::neo_hookean_isochoric},
      {"fung", LawKind::fung}};
  return names;
}

std::string_view name(LawKind kind) { return law_names()[static_cast<std::size_t>(kind)].first; }

void Parameters::check() const {
  if (!(exponent >= 0) || !(exponent <= kLargestExponent)) {
    throw InputError("exponent", fmt::format("the exponent b is {}; expected 0 to {}", exponent,
                                             kLargestExponent));
  }
}

Law::Law(LawKind kind, const fem::Material& material, const Parameters& parameters)
    : form_(form_of(kind, material, parameters)) {}

std::optional<double> Law::energy(const Eigen::Matrix3d& f) const {
  const Energy<double> energy =
      std::visit([&f](const auto& law) { return law.energy(by_rows(f)); }, form_);
  if (!energy.defined) return std::nullopt;
  return energy.density;
}

std::optional<Eigen::Matrix3d> Law::stress(const Eigen::Matrix3d& f) const {
  const Stress<double> stress =
      std::visit([&f](const auto& law) { return law.stress(by_rows(f)); }, form_);
  if (!stress.defined) return std::nullopt;
  return matrix(stress.p);
}

std::optional<fem::ElementMatrix> Law::tangent(const Eigen::Matrix3d& f,
                                               const fem::ElementGeometry& geometry,
                                               Linearisation linearisation) const {
  Gradients<double> g;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t i = 0; i < 3; ++i) g[a][i] = geometry.gradient[a][static_cast<int>(i)];
  }
  const Tangent<double> tangent = std::visit(
      [&](const auto& law) { return law.tangent(by_rows(f), g, geometry.volume(), linearisation); },
      form_);
  if (!tangent.defined) return std::nullopt;
  fem::ElementMatrix k;
  std::size_t block = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a; b < 4; ++b) {
      const Eigen::Matrix3d one = matrix(tangent.blocks[block++]);
      k.block<3, 3>(3 * b, 3 * a) = one.transpose();
      k.block<3, 3>(3 * a, 3 * b) = one;
    }
  }
  return k;
}

}  // namespace hvp::tissue
