#include "models/fit/qlv_tissue.h"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/tissue/column.h"

namespace hvp::fit {
namespace {

constexpr double kFramesOfAStep = 8;

double contact_of(const PressedLog& log, double contact) {
  // As in the fit, the load before the record counts as none.
  return std::max(log.direction * contact, log.shallowest());
}

// The column's forces at each sample of the log, in frames in which it moves evenly. Nothing where
// the law is not defined on the way.
std::optional<std::vector<double>> forces_along(const PressedLog& log, double contact,
                                                const tissue::Column& column,
                                                const std::vector<tissue::PronyTerm>& terms,
                                                double frame_s) {
  std::vector<double> depth;
  std::size_t piece = 0;
  const auto frames = static_cast<std::size_t>(std::ceil(log.seconds() / frame_s - 1e-9)) + 1;
  for (std::size_t n = 0; n < frames; ++n) {
    const double t = std::min(log.time.front() + frame_s * static_cast<double>(n), log.time.back());
    while (piece + 2 < log.time.size() && log.time[piece + 1] <= t) ++piece;
    const double share = (t - log.time[piece]) / (log.time[piece + 1] - log.time[piece]);
    depth.push_back(log.depth[piece] + share * (log.depth[piece + 1] - log.depth[piece]) - contact);
  }
  const std::optional<std::vector<double>> all =
      tissue::forces_over_time(column, tissue::PronySeries(terms, frame_s), depth);
  if (!all) return std::nullopt;
  std::vector<double> forces;
  for (const double time : log.time) {
    const double place = (time - log.time.front()) / frame_s;
    const auto before = std::min(static_cast<std::size_t>(place), frames - 1);
    const std::size_t after = std::min(before + 1, frames - 1);
    const double share = place - static_cast<double>(before);
    forces.push_back((*all)[before] + share * ((*all)[after] - (*all)[before]));
  }
  return forces;
}

tissue::Column column_of(const Specimen& specimen, double young_modulus_pa, double exponent) {
  const fem::Material material{.young_modulus_pa = young_modulus_pa,
                               .poisson_ratio = specimen.poisson_ratio};
  return {tissue::Law(tissue::LawKind::fung, material, {.exponent = exponent}), specimen.area_m2,
          specimen.height_m};
}

// The E (Pa) that is best for a b, and the sum of squares that it leaves, N².
struct Modulus {
  double young_modulus_pa = 0;
  double left = std::numeric_limits<double>::infinity();
};

class Match {
 public:
  Match(const PressedLog& log, double contact, const Specimen& specimen,
        const std::vector<tissue::PronyTerm>& terms, std::vector<double> target)
      : log_(log),
        contact_(contact),
        specimen_(specimen),
        terms_(terms),
        target_(std::move(target)) {}

  // Every law's force is E times that for an E of one.
  Modulus at(double exponent) const {
    const std::optional<std::vector<double>> unit = forces_along(
        log_, contact_, column_of(specimen_, 1, exponent), terms_, log_.step / kFramesOfAStep);
    if (!unit) return {};
    double both = 0;
    double square = 0;
    for (std::size_t i = 0; i < unit->size(); ++i) {
      both += (*unit)[i] * target_[i];
      square += (*unit)[i] * (*unit)[i];
    }
    Modulus result{.young_modulus_pa = both / square, .left = 0};
    for (std::size_t i = 0; i < unit->size(); ++i) {
      result.left += std::pow(result.young_modulus_pa * (*unit)[i] - target_[i], 2);
    }
    return result;
  }

 private:
  const PressedLog& log_;
  double contact_;
  const Specimen& specimen_;
  const std::vector<tissue::PronyTerm>& terms_;
  std::vector<double> target_;  // N
};

// Beyond it the column stiffens more than e^5 times as much as the fit within the log's depth.
double largest_exponent(const std::vector<double>& values, double depth, double height) {
  const double stretch = 1 - depth / height;
  const double strained = stretch * stretch + 2 / stretch - 3;
  const double stiffened = std::max(1.0, std::expm1(values[1] * depth) / (values[1] * depth));
  constexpr double kLargest = 1e4;  // what tissue::Parameters takes
  return std::min(kLargest, (5 + std::log(stiffened)) / strained);
}

// A column whose shear modulus outgrows κ is pressed together instead of widening, and gives way:
// there is a second minimum at a high b. So the lowest of a row of b is looked for first.
double closest_exponent(const Match& match, double largest) {
  constexpr int kTried = 40;
  constexpr double kSmallest = 1e-3;  // of the largest
  const auto tried = [&](int i) {
    return i < 0 ? 0.0 : largest * std::pow(kSmallest, 1 - static_cast<double>(i) / kTried);
  };
  int best = -1;
  double least = match.at(0).left;
  for (int i = 0; i <= kTried; ++i) {
    const double left = match.at(tried(i)).left;
    if (!(left < least)) continue;
    best = i;
    least = left;
  }
  constexpr int kBits = 24;
  return boost::math::tools::brent_find_minima(
             [&match](double exponent) { return match.at(exponent).left; }, tried(best - 1),
             tried(std::min(best + 1, kTried)), kBits)
      .first;
}

}  // namespace

QlvTissue qlv_tissue(const QlvSettings& settings, const PressedLog& log,
                     const std::vector<double>& values, const Specimen& specimen) {
  if (settings.elastic != Elastic::fung) {
    throw InputError("elastic",
                     "a power law has no stiffness at first touch, so no E; expected fung");
  }
  std::vector<double> target = qlv_force(settings, log, values);
  for (double& force : target) force -= values.back();
  const double contact = contact_of(log, values[values.size() - 2]);
  const double depth = log.deepest() - contact;
  column_of(specimen, 1, 0);  // refuses what is no column
  if (!(depth > 0)) throw InputError("contact", "the log never touches; expected it to press");
  if (!(depth < specimen.height_m)) {
    throw InputError("height", fmt::format("the specimen is {:g} m high and pressed by {:g} m; "
                                           "expected it higher",
                                           specimen.height_m, depth));
  }
  QlvTissue tissue{.young_modulus_pa = 0,
                   .poisson_ratio = specimen.poisson_ratio,
                   .exponent = 0,
                   .prony = {},
                   .deviation_n = 0};
  for (std::size_t i = 2; i + 2 < values.size(); i += 2) {
    tissue.prony.push_back({.share = values[i], .time_s = values[i + 1]});
  }
  const Match match(log, contact, specimen, tissue.prony, std::move(target));
  tissue.exponent = closest_exponent(match, largest_exponent(values, depth, specimen.height_m));
  const Modulus best = match.at(tissue.exponent);
  tissue.young_modulus_pa = best.young_modulus_pa;
  tissue.deviation_n = std::sqrt(best.left / static_cast<double>(log.time.size()));
  return tissue;
}

std::vector<double> qlv_tissue_force(const QlvTissue& tissue, const Specimen& specimen,
                                     const PressedLog& log, double contact, double offset,
                                     double frame_s) {
  std::optional<std::vector<double>> forces = forces_along(
      log, contact_of(log, contact), column_of(specimen, tissue.young_modulus_pa, tissue.exponent),
      tissue.prony, frame_s);
  if (!forces) throw std::invalid_argument("qlv_tissue_force: the law is not defined so deep");
  for (double& force : *forces) force += offset;
  return std::move(*forces);
}

std::vector<ScenarioWord> scenario_words(const QlvTissue& tissue) {
  std::string series;
  for (const tissue::PronyTerm& term : tissue.prony) {
    series += fmt::format("{}{{ share = {}, time = \"{} s\" }}", series.empty() ? "" : ", ",
                          toml_number(term.share), term.time_s);
  }
  return {{"object.material.young_modulus", fmt::format("\"{} Pa\"", tissue.young_modulus_pa)},
          {"object.material.poisson_ratio", toml_number(tissue.poisson_ratio)},
          {"object.model.kind", "\"fung\""},
          {"object.model.exponent", toml_number(tissue.exponent)},
          {"object.model.prony", "[" + series + "]"}};
}

}  // namespace hvp::fit
