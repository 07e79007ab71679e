#include "tables/fit/twins.h"

#include <cmath>
#include <memory>
#include <numbers>

#include "models/fem/structured_box.h"
#include "models/fit/bus_problem.h"
#include "models/fit/device_problem.h"
#include "models/fit/hand_problem.h"
#include "models/fit/tissue_problem.h"
#include "models/fit/twins.h"
#include "models/fit/wake_up_fit.h"
#include "models/plant/linear_axis.h"
#include "models/random/distribution.h"

namespace hvp::tables {

namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

fit::Options options() {
  fit::Options o;
  o.hold_out = 0;
  o.starts = 1;
  return o;
}

double normal(const random::Draws& draws, std::size_t i) {
  return fit::gaussian(draws.uniform(static_cast<std::int64_t>(i)), 1);
}

// The plant's own axis with dry friction, under a random force.
Twin device(const std::string& log, double noise, double step) {
  fit::DeviceTwin twin;
  twin.delay = 1.3e-3;
  twin.noise = noise;
  twin.step = step;
  return {"device",
          "4 s at 1 kHz, " + log,
          {{"mass", twin.mass},
           {"damping", twin.damping},
           {"coulomb", twin.coulomb},
           {"offset", twin.offset},
           {"delay", twin.delay}},
          [twin](std::int64_t seed) {
            fit::DeviceTwin of_seed = twin;
            of_seed.seed = seed;
            // Steps are no noise: another motion is another log.
            const auto command =
                fit::busy_command(4000, twin.period, 1.0, twin.step > 0 ? seed : 7);
            const fit::DeviceProblem problem(of_seed.follow(command), {});
            return fit::fit(problem, options());
          }};
}

// The plant's axis held by a hand, pushed by six sinusoids.
Twin hand() {
  plant::LinearAxis axis;
  axis.mass = 1.5;
  axis.hand_stiffness = 375;
  axis.hand_damping = 4.5;
  const std::vector<std::pair<std::string, double>> truth = {
      {"mass", axis.mass}, {"stiffness", axis.hand_stiffness}, {"damping", axis.hand_damping}};
  return {"hand", "4 s at 1 kHz, 20 um of white noise, intended motion unknown", truth,
          [axis](std::int64_t seed) {
            constexpr double kPeriod = 1e-3;
            fit::HandLog log{kPeriod, {}, {}, {}};
            std::vector<double> intended;
            for (int i = 0; i < 4000; ++i) {
              const double t = i * kPeriod;
              double force = 0;
              for (const double f : {1.3, 2.9, 4.7, 7.1, 11.0, 17.0}) {
                force += std::sin(kTwoPi * f * t + f);
              }
              log.force.push_back(force);
              intended.push_back(0.02 * std::sin(kTwoPi * 0.4 * t));
            }
            const random::Draws draws(seed, "hand twin");
            plant::LinearAxis::State state;
            for (std::size_t i = 0; i < log.force.size(); ++i) {
              log.position.push_back(state.x + 20e-6 * normal(draws, i));
              if (i + 1 == log.force.size()) break;
              plant::LinearAxis::Drive drive;
              drive.external = {log.force[i], (log.force[i + 1] - log.force[i]) / kPeriod};
              drive.intended = {intended[i], (intended[i + 1] - intended[i]) / kPeriod};
              state = axis.after(kPeriod, state, drive);
            }
            return fit::fit(fit::HandProblem(log, {}), options());
          }};
}

Twin qlv() {
  const std::vector<double> values = {170, 600, 0.62, 0.3, 0.18, 4, 0.4e-3, 0.01};
  const char* const names[] = {"c", "q", "g1", "tau1", "g2", "tau2", "contact", "offset"};
  std::vector<std::pair<std::string, double>> truth;
  for (std::size_t i = 0; i < values.size(); ++i) truth.emplace_back(names[i], values[i]);
  return {"qlv", "16 s at 10 Hz, 5 mN of white noise", truth, [values](std::int64_t seed) {
            const fit::QlvSettings settings;
            const fit::IndentationLog log = fit::press({}, settings, values, 5e-3, seed);
            return fit::fit(fit::QlvProblem(settings, log), options());
          }};
}

// The platform's own body, by its own time integration and its direct solver.
Twin tissue() {
  auto body = std::make_shared<fit::TissueBody>();
  body->mesh = fem::structured_box({0.1, 0.1, 0.1}, {2, 2, 2});
  int top = 0;
  for (int node = 0; node < static_cast<int>(body->mesh.nodes.size()); ++node) {
    const Eigen::Vector3d& at = body->mesh.nodes[static_cast<std::size_t>(node)];
    if (at.z() < 1e-9) body->anchored.push_back(node);
    if ((at - Eigen::Vector3d(0.05, 0.05, 0.1)).norm() < 1e-9) top = node;
  }
  body->dynamics = fem::Dynamics{.newmark_beta = 0.605, .newmark_gamma = 0.6};
  const fit::TissueValues values{8e3, 0.42, 6.0, 2e-3};
  return {
      "tissue",
      "0.6 s at 500 Hz, 2 mN of white noise, E, α and β with ν known",
      {{"young_modulus", values.young_modulus},
       {"mass_damping", values.mass_damping},
       {"stiffness_damping", values.stiffness_damping}},
      [body, values, top](std::int64_t seed) {
        const std::vector<double> way = fit::press_and_sweep({}, body->period_s);
        const fit::TissueLog log = fit::touch(*body, values, {top}, {0, 0, -1}, way, 2e-3, seed);
        fit::Options o = options();
        o.fixed["poisson_ratio"] = values.poisson_ratio;
        return fit::fit(fit::TissueProblem(*body, {log}), o);
      }};
}

Twin bus() {
  constexpr double kLatency = 0.9e-6;
  constexpr double kBandwidth = 105e6;
  return {"bus",
          "210 transfers of 64 bytes to 4 KiB, 30 ns of white noise, one in 17 interrupted",
          {{"latency", kLatency}, {"bandwidth", kBandwidth}},
          [](std::int64_t seed) {
            fit::TransferLog log{.bytes = {}, .seconds = {}};
            const random::Draws draws(seed, "bus twin");
            for (std::size_t i = 0; i < 210; ++i) {
              const double bytes = 64.0 * static_cast<double>(1U << (i % 7));
              log.bytes.push_back(bytes);
              const double interrupted = i % 17 == 5 ? 20e-6 : 0;
              log.seconds.push_back(kLatency + bytes / kBandwidth + 30e-9 * normal(draws, i) +
                                    interrupted);
            }
            fit::Options o = options();
            o.loss = fit::Loss::cauchy;
            return fit::fit(fit::BusProblem(log), o);
          }};
}

// The wake-up latencies that the platform itself would draw, in whole microseconds as cyclictest
// counts them.
Twin host() {
  random::TimeDistribution d;
  d.kind = random::TimeDistribution::Kind::lognormal;
  d.median_s = 8e-6;
  d.spread = 1.7;
  d.maximum_s = 500e-6;
  return {"host",
          "a histogram of 2000 latencies in whole microseconds, lognormal",
          {{"median", d.median_s}, {"spread", d.spread}},
          [d](std::int64_t seed) {
            constexpr double kBin = 1e-6;
            const random::Source source(d, seed, "host twin");
            fit::WakeUpHistogram h;
            for (int i = 0; i < 2000; ++i) {
              const auto place = static_cast<std::size_t>(source.time_s(i) / kBin);
              while (h.bins.size() <= place) {
                const auto n = static_cast<double>(h.bins.size());
                h.bins.push_back({n * kBin, (n + 1) * kBin, 0});
              }
              ++h.bins[place].count;
            }
            return fit::fit_wake_up(h).fit;
          }};
}

}  // namespace

std::vector<Twin> twins() {
  return {device("20 um of white noise", 20e-6, 0),
          device("an encoder of 55 um", 0, 55e-6),
          hand(),
          qlv(),
          tissue(),
          bus(),
          host()};
}

}  // namespace hvp::tables
