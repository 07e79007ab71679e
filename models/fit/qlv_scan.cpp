#include "models/fit/qlv_scan.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <string>

#include "models/fit/coordinates.h"
#include "models/fit/search.h"

namespace hvp::fit {

namespace {

constexpr std::size_t kMostPlaces = 12;
constexpr int kIterations = 30;
constexpr double kFurther = 0.1;  // of the stroke, beyond where the force has risen

// Depths (m) between samples from the first place to somewhat beyond the first load.
std::vector<double> places(const PressedLog& log) {
  const double first = log.shallowest();
  const double last = std::min(log.deepest(), log.first_loaded() + kFurther * log.stroke());
  std::vector<double> between;
  for (std::size_t i = 1; i < log.depth.size(); ++i) {
    const double middle = 0.5 * (log.depth[i - 1] + log.depth[i]);
    if (middle > last) break;
    if (log.depth[i] > log.depth[i - 1] && middle > first) between.push_back(middle);
  }
  std::vector<double> chosen{first};
  const std::size_t every = (between.size() + kMostPlaces - 1) / kMostPlaces;
  for (std::size_t i = 0; i < between.size(); i += std::max<std::size_t>(1, every)) {
    chosen.push_back(between[i]);
  }
  return chosen;
}

struct Trial {
  double sum = std::numeric_limits<double>::infinity();
  std::size_t place = 0;
  std::vector<double> values;
};

Trial try_contact(const Problem& problem, const std::vector<Parameter>& parameters,
                  const PressedLog& log, double depth) {
  const Coordinates coordinates(parameters, {{"contact", log.direction * depth}});
  Search search(problem, coordinates,
                {{static_cast<int>(log.force.size())}, log.force_range(), kIterations}, {});
  Point start;
  start.own.resize(1);
  for (std::size_t k = 0; k < coordinates.size(); ++k) {
    start.z.push_back(coordinates.inner(k, coordinates[k].start));
  }
  const Optimum optimum = search.from(start);
  if (!optimum.found) return {};
  return {optimum.sum, 0, coordinates.values(optimum.at.z.data())};
}

}  // namespace

void begin_at_best_contact(const Problem& problem, const PressedLog& log,
                           std::vector<Parameter>& parameters) {
  const std::vector<double> depths = places(log);
  Trial best;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    Trial trial = try_contact(problem, parameters, log, depths[i]);
    if (!(trial.sum < best.sum)) continue;
    best = std::move(trial);
    best.place = i;
  }
  if (best.values.empty()) return;
  for (std::size_t i = 0; i < parameters.size(); ++i) parameters[i].start = best.values[i];

  const auto contact = std::find_if(parameters.begin(), parameters.end(),
                                    [](const Parameter& p) { return p.name == "contact"; });
  double from = depths[best.place > 0 ? best.place - 1 : 0];
  double to = depths[std::min(best.place + 1, depths.size() - 1)];
  if (best.place == 0) {
    to = log.shallowest() - 0.01 * log.stroke();
    from = log.shallowest() - 0.1 * log.stroke();
    (log.direction > 0 ? contact->low : contact->high) = log.direction * from;
    contact->start = log.direction * 0.5 * (from + to);
  }
  contact->draw_low = std::min(log.direction * from, log.direction * to);
  contact->draw_high = std::max(log.direction * from, log.direction * to);
}

}  // namespace hvp::fit
