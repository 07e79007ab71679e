#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <string>

#include <fmt/format.h>

#include "models/fit/coordinates.h"
#include "models/fit/qlv_problem.h"
#include "models/fit/search.h"

namespace hvp::fit {

namespace {

// Part of a record that holds, where nothing else is known.
constexpr double kHold = 0.75;
constexpr double kWidestForce = 1e4;  // factor about the start of c

// The starts of the time constants and the ranges from which they are drawn, as shares of the hold.
// They are apart, so that every attempt begins with them in order.
struct Tau {
  double start;
  double low;
  double high;
};
std::vector<Tau> taus_of(int exponentials) {
  switch (exponentials) {
    case 1:
      return {{0.2, 0.02, 1}};
    case 2:
      return {{0.04, 0.012, 0.1}, {0.4, 0.15, 1}};
    default:
      return {{0.02, 0.008, 0.04}, {0.12, 0.05, 0.2}, {0.6, 0.25, 1.2}};
  }
}

Parameter stiffness(const QlvSettings& settings, double peak, double depth) {
  Parameter c{.name = "c",
              .unit = "N/m",
              .because = "the record's force and stroke, and a factor of ten thousand",
              .logarithmic = true,
              .remedy = "a deeper ramp"};
  if (settings.elastic == Elastic::fung) {
    const double q = 3 / depth;
    c.start = 2 * peak * q / std::expm1(3);
    c.draw_low = 0.1 * c.start;
    c.draw_high = 5 * c.start;
    c.low = c.start / kWidestForce;
    c.high = c.start * kWidestForce;
    return c;
  }
  c.unit = "N/m^n";
  c.start = 2 * peak / std::pow(depth, 2);
  c.draw_low = 0.3 * c.start;
  c.draw_high = 3 * c.start;
  // n moves it by powers of the depth.
  c.low = 1e-3 * peak / depth;
  c.high = 1e3 * peak / std::pow(std::min(depth, 1e-3), 6);
  return c;
}

Parameter curvature(const QlvSettings& settings, double depth) {
  if (settings.elastic == Elastic::power) {
    return {.name = "n",
            .unit = "",
            .start = 2,
            .low = 1,
            .high = 6,
            .because = "tissue stiffens, and is not infinitely stiff at first touch",
            .logarithmic = false,
            .draw_low = 1.2,
            .draw_high = 3,
            .matters = 0.1,
            .remedy = "a deeper ramp"};
  }
  return {.name = "q",
          .unit = "1/m",
          .start = 3 / depth,
          .low = 0.01 / depth,
          .high = 30 / depth,
          .because = "within the stroke the stiffness grows by 1 % to a factor of e^30",
          .logarithmic = true,
          .draw_low = 1 / depth,
          .draw_high = 6 / depth,
          .matters = 0.1 / depth,
          .remedy = "a deeper ramp"};
}

void add_relaxation(const QlvSettings& settings, const PressedLog& log,
                    std::vector<Parameter>& parameters) {
  const double hold = kHold * log.seconds();
  const std::vector<Tau> taus = taus_of(settings.exponentials);
  const auto count = static_cast<double>(taus.size());
  for (std::size_t i = 0; i < taus.size(); ++i) {
    parameters.push_back({.name = fmt::format("g{}", i + 1),
                          .unit = "",
                          .start = 0.7 / count,
                          .low = 0,
                          .high = 1,
                          .because = "relaxation takes force away, and at most all of it",
                          .logarithmic = false,
                          .draw_low = 0.1 / count,
                          .draw_high = 0.95 / count,
                          .matters = 0.05,
                          .remedy = "a faster ramp"});
    const double low = 0.5 * log.step;
    const double high = 10 * log.seconds();
    const auto within = [&](double share) { return std::clamp(share * hold, 1.01 * low, high); };
    parameters.push_back(
        {.name = fmt::format("tau{}", i + 1),
         .unit = "s",
         .start = within(taus[i].start),
         .low = low,
         .high = high,
         .because = "between half a step and ten times the record",
         .logarithmic = true,
         .draw_low = within(taus[i].low),
         .draw_high = within(taus[i].high),
         .matters = log.step,
         .remedy = i + 1 == taus.size()
                       ? fmt::format("a hold at least three times as long as tau{}", i + 1)
                       : "a faster ramp, sampled more often"});
  }
}

}  // namespace

std::vector<Parameter> qlv_parameters(const QlvSettings& settings, const PressedLog& log) {
  const double loaded = std::max(log.deepest() - log.first_loaded(), 0.1 * log.stroke());
  const double peak = log.force_range();
  std::vector<Parameter> parameters{stiffness(settings, peak, loaded), curvature(settings, loaded)};
  add_relaxation(settings, log, parameters);

  // In the travel's own sign. The contact is sought between the places that the indenter was at.
  const double touched = std::clamp(log.first_loaded(), log.shallowest(), log.deepest());
  const double begin = touched - 0.3 * (touched - log.depth.front());
  const std::array<double, 2> ends{log.direction * log.shallowest(), log.direction * log.deepest()};
  const double drawn = std::min(log.deepest(), touched + 0.1 * log.stroke());
  const std::array<double, 2> draws{log.direction * log.shallowest(), log.direction * drawn};
  parameters.push_back({.name = "contact",
                        .unit = "m",
                        .start = std::clamp(log.direction * begin, std::min(ends[0], ends[1]),
                                            std::max(ends[0], ends[1])),
                        .low = std::min(ends[0], ends[1]),
                        .high = std::max(ends[0], ends[1]),
                        .because = "where the indenter has been",
                        .logarithmic = false,
                        .draw_low = std::min(draws[0], draws[1]),
                        .draw_high = std::max(draws[0], draws[1]),
                        .matters = 0.02 * log.stroke(),
                        .remedy = "samples before contact"});
  const double rest = log.before_contact();
  parameters.push_back({.name = "offset",
                        .unit = "N",
                        .start = rest,
                        .low = rest - peak,
                        .high = rest + peak,
                        .because = "within the record's range of force from its first one",
                        .logarithmic = false,
                        .draw_low = rest - 0.02 * peak,
                        .draw_high = rest + 0.02 * peak,
                        .matters = 0.01 * peak,
                        .remedy = "samples before contact"});
  return parameters;
}

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
