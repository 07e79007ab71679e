#include "models/fit/qlv_response.h"

#include <algorithm>
#include <array>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::fit::qlv_response_test {
namespace {

constexpr double kContact = 0.43e-3;  // m, within a piece
constexpr double kOffset = 0.01;      // N
const std::array<Relaxation<double>, 2> kRelaxation{{{0.6, 0.31}, {0.2, 4.0}}};

// In, on, partly out, on again, out of contact, and in once more, with uneven steps.
PressedLog motion() {
  PressedLog log;
  log.time = {0, 0.1, 0.2, 0.31, 0.5, 0.6, 1.0, 1.1, 1.25, 1.3, 1.5, 1.6, 1.7};
  log.depth = {0,      0.2e-3, 1e-3, 2e-3,   2e-3, 1.6e-3, 1.6e-3,
               2.5e-3, 0.1e-3, 0,    0.6e-3, 3e-3, 0.44e-3};
  log.force.assign(log.time.size(), 0.0);
  return log;
}

double reduced_relaxation(double t) {
  double g = 1;
  for (const auto& r : kRelaxation) g -= r.share * (1 - std::exp(-t / r.tau));
  return g;
}

// The definition: ∫ G(t − s)·F_e'(δ)·δ' ds over all loaded parts before t, by double exponential
// quadrature, which is good at ends where the integrand is not smooth.
template <class Slope>
double by_quadrature(const PressedLog& log, std::size_t sample, const Slope& slope) {
  boost::math::quadrature::tanh_sinh<double> integrate;
  double force = kOffset;
  for (std::size_t i = 1; i <= sample; ++i) {
    const double from = log.depth[i - 1] - kContact;
    const double to = log.depth[i] - kContact;
    if (std::max(from, to) <= 0 || from == to) continue;
    const double seconds = log.time[i] - log.time[i - 1];
    const double begin = from > 0 ? 0 : seconds * from / (from - to);
    const double end = to > 0 ? seconds : seconds * from / (from - to);
    const double speed = (to - from) / seconds;
    // From the end nearer to the contact, so that its depth has no cancellation.
    const double shallow = std::max(0.0, std::min(from, to));
    const double length = end - begin;
    force += integrate.integrate(
        [&](double u) {
          const double depth = shallow + std::abs(speed) * u;
          const double s = log.time[i - 1] + (speed > 0 ? begin + u : end - u);
          return reduced_relaxation(log.time[sample] - s) * slope(depth) * speed;
        },
        0.0, length, 1e-13);
  }
  return force;
}

template <class Elasticity, class Slope>
void expect_definition(const Elasticity& elasticity, const Slope& slope, double tolerance) {
  const PressedLog log = motion();
  std::vector<double> force(log.time.size());
  qlv_response(log, elasticity, kRelaxation, kContact, kOffset, force.data());
  double largest = 0;
  for (const double f : force) largest = std::max(largest, std::abs(f));
  for (std::size_t i = 0; i < force.size(); ++i) {
    EXPECT_NEAR(force[i], by_quadrature(log, i, slope), tolerance * largest) << "sample " << i;
  }
}

TEST(QlvResponse, FungsClosedFormIsTheIntegral) {
  for (const double q : {1.0, 50.0, 450.0, 1500.0}) {
    const double c = 120;
    expect_definition(
        FungElasticity<double>{c, q}, [&](double depth) { return c * std::exp(q * depth); }, 1e-12);
  }
}

TEST(QlvResponse, ThePowerLawIsTheIntegral) {
  for (const double n : {1.0, 1.3, 1.5, 2.0, 2.7, 4.0}) {
    const double c = 0.8 * std::pow(2e-3, -n);
    expect_definition(
        PowerElasticity<double>{c, n}, [&](double depth) { return c * n * std::pow(depth, n - 1); },
        1e-11);
  }
}

// Unloading as fast as relaxation: the exponent's slope q·δ' + 1/τ is zero, and small beside it.
TEST(QlvResponse, ThereIsNoSingularityWhereUnloadingIsAsFastAsRelaxation) {
  const FungElasticity<double> fung{120, 500};
  const double tau = 0.4;
  for (const double off : {0.0, 1e-12, -1e-12, 1e-9, 1e-6, -1e-6, 1e-3, -1e-3, 0.49, 0.51, -0.51}) {
    const double seconds = 0.1;
    const double moved = (off - seconds / tau) / fung.q;
    const LoadedPiece<double> piece{2e-3, 2e-3 + moved, seconds};
    // c·δ'·e^(qδ₁)·∫ e^(−(q·δ' + 1/τ)·u) du by its series in the exponent.
    double series = 0;
    double term = 1;
    for (int k = 1; k < 40; ++k) {
      series += term;
      term *= -off / (k + 1);
    }
    const double expected = fung.c * moved * std::exp(fung.q * piece.to) * series;
    EXPECT_NEAR(fung.remaining(piece, tau), expected, 1e-13 * std::abs(expected)) << off;
  }
}

// A force that relaxes at once leaves nothing, one that does not relax all of it.
TEST(QlvResponse, AStepDecaysBetweenItsLimits) {
  const FungElasticity<double> fung{100, 600};
  const PowerElasticity<double> power{1e5, 2.1};
  const LoadedPiece<double> piece{0, 1e-3, 0.1};
  EXPECT_NEAR(fung.remaining(piece, 1e9), fung.force(1e-3), 1e-9);
  EXPECT_NEAR(power.remaining(piece, 1e9), power.force(1e-3), 1e-9);
  EXPECT_LT(fung.remaining(piece, 1e-4), 0.01 * fung.force(1e-3));
}

// After a ramp to a depth that then stays, the force goes to (1 − Σg)·F_e.
TEST(QlvResponse, AHeldDepthRelaxesToItsLastShare) {
  const FungElasticity<double> fung{100, 600};
  PressedLog log;
  for (int i = 0; i < 1000; ++i) {
    log.time.push_back(0.1 * i);
    log.depth.push_back(std::min(2e-3, 1e-4 * i));
  }
  log.force.assign(log.time.size(), 0.0);
  std::vector<double> force(log.time.size());
  qlv_response(log, fung, kRelaxation, 0.0, 0.0, force.data());
  EXPECT_NEAR(force.back(), 0.2 * fung.force(2e-3), 1e-9);
}

// Before contact there is the offset and nothing else, and the first loaded piece counts from the
// contact on.
TEST(QlvResponse, OnlyTheLoadedPartOfAPieceCounts) {
  const PressedLog log = motion();
  const FungElasticity<double> fung{100, 600};
  std::vector<double> force(log.time.size());
  qlv_response(log, fung, kRelaxation, kContact, kOffset, force.data());
  EXPECT_EQ(force[0], kOffset);
  EXPECT_EQ(force[1], kOffset);
  EXPECT_GT(force[2], kOffset);
  EXPECT_LT(force[2], kOffset + fung.force(1e-3 - kContact));
}

}  // namespace
}  // namespace hvp::fit::qlv_response_test
