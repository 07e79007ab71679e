#include "models/tissue/prony.h"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/counted.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::prony_test {
namespace {

// Frames of a hundredth of a time of relaxation up to a hundred of them.
constexpr double kFrames[] = {0.01, 0.1, 0.5, 1, 3, 10, 100};
constexpr std::array<PronyTerm, 1> kOne = {{{.share = 0.7, .time_s = 1}}};
// About what meat has.
constexpr std::array<PronyTerm, 2> kMeat = {
    {{.share = 0.62, .time_s = 0.31}, {.share = 0.19, .time_s = 3.9}}};

// The forces at the end of each frame for elastic ones at the end of each.
std::vector<double> response(std::span<const PronyTerm> terms, double step,
                             const std::vector<double>& elastic) {
  PronyForces<double> memory(PronySeries(terms, step), 1);
  std::vector<double> forces;
  for (const double& e : elastic) {
    double force = 0;
    memory.forces({&e, 1}, {&force, 1});
    memory.commit({&e, 1});
    forces.push_back(force);
  }
  return forces;
}

double relaxation(std::span<const PronyTerm> terms, double t) {
  double left = 1;
  for (const PronyTerm& term : terms) left -= term.share * (1 - std::exp(-t / term.time_s));
  return left;
}

// ∫ G over 0 to t.
double integral(std::span<const PronyTerm> terms, double t) {
  double sum = t;
  for (const PronyTerm& term : terms) {
    sum -= term.share * (t - term.time_s * (1 - std::exp(-t / term.time_s)));
  }
  return sum;
}

// The load of a frame and then a hold: what is left is the mean of G over the frame.
TEST(Prony, AStepRelaxesAsInClosedForm) {
  for (const double step : kFrames) {
    for (const std::span<const PronyTerm> terms : {std::span<const PronyTerm>(kOne), {kMeat}}) {
      const std::vector<double> force = response(terms, step, std::vector<double>(300, 2.0));
      for (std::size_t n = 0; n < force.size(); ++n) {
        const double t = step * static_cast<double>(n);
        const double mean = (integral(terms, t + step) - integral(terms, t)) / step;
        // The closed form is a difference of numbers of the size of t.
        EXPECT_NEAR(force[n], 2 * mean, 1e-14 * (1 + (t + 1) / step)) << step << " " << n;
      }
    }
  }
  // With short frames it is G itself.
  const std::vector<double> force = response(kOne, 1e-4, std::vector<double>(20001, 1.0));
  EXPECT_NEAR(force[20000], relaxation(kOne, 2.00005), 1e-9);
}

// A force that rises by one each second, and then stays.
TEST(Prony, ARampIsAsInClosedForm) {
  for (const double step : kFrames) {
    constexpr int kRising = 40;
    std::vector<double> elastic;
    for (int n = 1; n <= 200; ++n) elastic.push_back(step * std::min(n, kRising));
    const std::vector<double> force = response(kMeat, step, elastic);
    for (std::size_t i = 0; i < force.size(); ++i) {
      const double t = step * static_cast<double>(i + 1);
      const double since = std::max(0.0, t - step * kRising);
      EXPECT_NEAR(force[i], integral(kMeat, t) - integral(kMeat, since), 1e-13 * (1 + t))
          << step << " " << i;
    }
  }
}

// G* of a sinusoid in closed form: storage g∞ + Σ g·(ωτ)²/(1 + (ωτ)²), loss Σ g·ωτ/(1 + (ωτ)²).
std::complex<double> modulus(std::span<const PronyTerm> terms, double omega) {
  std::complex<double> g = relaxation(terms, HUGE_VAL);
  for (const PronyTerm& term : terms) {
    const double x = omega * term.time_s;
    g += term.share * std::complex<double>(x * x, x) / (1 + x * x);
  }
  return g;
}

// What is measured of the last of many periods, of so many frames each.
std::complex<double> measured(std::span<const PronyTerm> terms, double omega, int frames) {
  const double step = 2 * std::numbers::pi / omega / frames;
  double slowest = 0;
  for (const PronyTerm& term : terms) slowest = std::max(slowest, term.time_s);
  const int periods = 2 + static_cast<int>(40 * slowest / (step * frames));
  std::vector<double> elastic;
  const auto phase = [&](int n) { return 2 * std::numbers::pi * (n % frames) / frames; };
  for (int n = 1; n <= periods * frames; ++n) elastic.push_back(std::sin(phase(n)));
  const std::vector<double> force = response(terms, step, elastic);
  std::complex<double> sum = 0;
  for (int n = (periods - 1) * frames + 1; n <= periods * frames; ++n) {
    sum += force[static_cast<std::size_t>(n - 1)] *
           std::complex<double>(std::sin(phase(n)), std::cos(phase(n)));
  }
  return 2.0 * sum / static_cast<double>(frames);
}

// The same of frames: with z = e^(iωΔt), H = g∞ + Σ c·(z − 1)/(z − a), a = e^(−Δt/τ).
std::complex<double> sampled(std::span<const PronyTerm> terms, double omega, double step) {
  const std::complex<double> z = std::polar(1.0, omega * step);
  std::complex<double> h = relaxation(terms, HUGE_VAL);
  for (const PronyTerm& term : terms) {
    const double a = std::exp(-step / term.time_s);
    h += term.share * (1 - a) * term.time_s / step * (z - 1.0) / (z - a);
  }
  return h;
}

// A straight line between samples errs by up to (ωΔt)²/8, of which the relaxing shares see no more
// than themselves.
TEST(Prony, ASinusoidHasItsStorageAndLoss) {
  for (const std::span<const PronyTerm> terms : {std::span<const PronyTerm>(kOne), {kMeat}}) {
    const double relaxing = 1 - relaxation(terms, HUGE_VAL);
    for (const double step : kFrames) {
      constexpr int kPeriod = 64;
      const double angle = 2 * std::numbers::pi / kPeriod;
      const std::complex<double> found = measured(terms, angle / step, kPeriod);
      EXPECT_LT(std::abs(found - sampled(terms, angle / step, step)), 1e-12) << step;
      const std::complex<double> expected = modulus(terms, angle / step);
      EXPECT_LT(std::abs(found - expected), relaxing * angle * angle / 8) << step;
      EXPECT_NEAR(found.imag(), expected.imag(), angle * angle / 6 * expected.imag()) << step;
    }
    // The error falls to a quarter with half the frame.
    const double omega = 2;
    const auto error = [&](int frames) {
      return std::abs(measured(terms, omega, frames) - modulus(terms, omega));
    };
    EXPECT_NEAR(error(256) / error(512), 4, 0.05);
  }
}

TEST(Prony, WithoutTermsItIsTheElasticForce) {
  const PronySeries none({}, 1e-3);
  EXPECT_EQ(none.stiffness_factor(), 1);
  EXPECT_EQ(none.remaining(), 1);
  EXPECT_EQ(response({}, 1e-3, {1, -2, 0.3}), (std::vector<double>{1, -2, 0.3}));
}

// The factor of K is the share of a change within the frame: 1 for short ones, g∞ for long ones.
TEST(Prony, FactorOfTheStiffness) {
  for (const double step : kFrames) {
    const PronySeries series(kMeat, step);
    EXPECT_NEAR(series.stiffness_factor(), integral(kMeat, step) / step, 1e-14);
    PronyForces<double> memory(series, 1);
    const auto force_of = [&memory](double elastic) {
      double force = 0;
      memory.forces({&elastic, 1}, {&force, 1});
      return force;
    };
    const double pressed = 3;
    memory.commit({&pressed, 1});
    EXPECT_NEAR(force_of(4) - force_of(3), series.stiffness_factor(), 1e-14);
  }
  EXPECT_NEAR(PronySeries(kMeat, 1e-6).stiffness_factor(), 1, 2e-6);
  EXPECT_NEAR(PronySeries(kMeat, 1e6).stiffness_factor(), 0.19, 2e-6);
  EXPECT_NEAR(PronySeries(kMeat, 1).remaining(), 0.19, 1e-15);
}

// What a linear spring takes in round a loop that begins at rest and ends where it began, J. Forces
// are taken as straight lines between frames.
double work_round_a_loop(double step, const std::vector<double>& travel) {
  constexpr double kStiffness = 120;  // N/m
  std::vector<double> elastic;
  for (const double x : travel) elastic.push_back(kStiffness * x);
  const std::vector<double> force = response(kMeat, step, elastic);
  double work = 0.5 * force[0] * travel[0];
  for (std::size_t n = 1; n < travel.size(); ++n) {
    work += 0.5 * (force[n] + force[n - 1]) * (travel[n] - travel[n - 1]);
  }
  return work;
}

TEST(Prony, NoLoopGivesEnergy) {
  for (const double step : kFrames) {
    for (unsigned seed = 0; seed < 50; ++seed) {
      std::vector<double> travel;
      double x = 0;
      for (unsigned n = 0; n < 60; ++n) {
        x += 1e-3 * fem::noise(1000 * seed + n);
        travel.push_back(x);
      }
      // A fast way back, a slow one, and one with a pause before it.
      const unsigned back = 1 + seed % 20;
      for (unsigned n = 1; n <= back; ++n) travel.push_back(x * (back - n) / back);
      EXPECT_EQ(travel.back(), 0);
      EXPECT_GT(work_round_a_loop(step, travel), 1e-9) << step << " " << seed;
    }
  }
}

TEST(Prony, OnlyACommitLeavesATrace) {
  const PronySeries series(kMeat, 0.1);
  PronyForces<double> plain(series, 2);
  PronyForces<double> tried(series, 2);
  for (unsigned n = 0; n < 40; ++n) {
    const std::vector<double> elastic = {fem::noise(n), fem::noise(n + 100)};
    const std::vector<double> missed = {5, fem::noise(n + 200)};
    std::vector<double> a(2);
    std::vector<double> b(2);
    tried.forces(missed, b);
    plain.forces(elastic, a);
    tried.forces(elastic, b);
    EXPECT_EQ(a, b);
    plain.commit(elastic);
    tried.commit(elastic);
  }
}

// A frame in which nothing moves is committed with the forces of the one before: time goes on.
TEST(Prony, AMissedFrameRelaxes) {
  const PronySeries series(kOne, 0.5);
  PronyForces<double> memory(series, 1);
  const double pressed = 1;
  double before = 0;
  double after = 0;
  memory.forces({&pressed, 1}, {&before, 1});
  memory.commit({&pressed, 1});
  memory.commit({&pressed, 1});
  memory.forces({&pressed, 1}, {&after, 1});
  EXPECT_NEAR((after - 0.3) / (before - 0.3), std::exp(-2 * 0.5), 1e-14);
}

TEST(Prony, AtRestNothingIsRemembered) {
  const PronySeries series(kMeat, 0.1);
  PronyForces<double> memory(series, 1);
  const double pressed = 5;
  const double kept = 2;
  double force = 0;
  memory.commit({&pressed, 1});
  memory.rest({&kept, 1});
  for (int n = 0; n < 3; ++n) {
    memory.forces({&kept, 1}, {&force, 1});
    memory.commit({&kept, 1});
    EXPECT_NEAR(force, 2 * 0.19, 1e-14);
  }
}

// Two memories by element are the memory of their sum.
TEST(Prony, TheMemoryOfASumIsTheSumOfMemories) {
  std::vector<double> one;
  std::vector<double> other;
  std::vector<double> both;
  for (unsigned n = 0; n < 50; ++n) {
    one.push_back(fem::noise(n));
    other.push_back(fem::noise(n + 500));
    both.push_back(one.back() + other.back());
  }
  const std::vector<double> a = response(kMeat, 0.2, one);
  const std::vector<double> b = response(kMeat, 0.2, other);
  const std::vector<double> sum = response(kMeat, 0.2, both);
  for (std::size_t n = 0; n < sum.size(); ++n) EXPECT_NEAR(sum[n], a[n] + b[n], 1e-14);
}

// The limit of a memory in fixed axes. A tetrahedron is deformed, has relaxed, and is turned at
// once: its force should turn with it and be g∞ of the elastic one, but what has relaxed stays
// behind in the old direction, until it fades.
TEST(Prony, TheMemoryDoesNotTurnWithTheBody) {
  const Law law(LawKind::fung, reference_material());
  const Eigen::Matrix<double, 3, 4> before = node_forces(law, reference_deformation());
  const Eigen::Matrix<double, 3, 4> after =
      node_forces(law, reference_rotation() * reference_deformation());
  const PronySeries series(kOne, 1e-6);
  PronyForces<double> memory(series, 12);
  memory.rest({before.data(), 12});
  Eigen::Matrix<double, 3, 4> force;
  memory.forces({after.data(), 12}, {force.data(), 12});
  const double error = (force - series.remaining() * after).norm();
  EXPECT_NEAR(error, 0.7 * (after - before).norm(), 1e-5 * error);
  EXPECT_GT(error, 0.3 * after.norm());

  PronyForces<double> later(PronySeries(kOne, 1), 12);
  later.rest({before.data(), 12});
  for (int n = 0; n < 40; ++n) later.commit({after.data(), 12});
  later.forces({after.data(), 12}, {force.data(), 12});
  EXPECT_LT((force - series.remaining() * after).norm(), 1e-12 * after.norm());
}

TEST(Prony, OperationsAreWhatItDoes) {
  for (const std::span<const PronyTerm> terms :
       {std::span<const PronyTerm>(), {kOne}, std::span<const PronyTerm>(kMeat)}) {
    PronyForces<Counted> memory(PronySeries(terms, 0.1), 5);
    const std::vector<Counted> elastic(5, Counted(2));
    std::vector<Counted> total(5);
    Counted::count = {};
    Operations said = memory.forces(elastic, total);
    EXPECT_EQ(Counted::count, said);
    Counted::count = {};
    said = memory.commit(elastic);
    EXPECT_EQ(Counted::count, said);
    // Four a term and component, and two that they share.
    EXPECT_EQ(said.total(), 5.0 * (2 + 4.0 * static_cast<double>(terms.size())));
  }
}

TEST(Prony, CallsDoNotAllocate) {
  PronyForces<double> memory(PronySeries(kMeat, 0.1), 30);
  std::vector<double> elastic(30, 1.0);
  std::vector<double> total(30);
  const std::size_t before = test::allocation_count();
  memory.rest(elastic);
  memory.forces(elastic, total);
  memory.commit(elastic);
  EXPECT_EQ(test::allocation_count(), before);
}

void expect_refused(const std::vector<PronyTerm>& terms, const std::string& key) {
  try {
    check_prony(terms);
    ADD_FAILURE() << key;
  } catch (const InputError& error) {
    EXPECT_EQ(error.key(), key);
    EXPECT_NE(std::string(error.what()).find("expected"), std::string::npos);
  }
}

TEST(Prony, RefusesWhatIsNoRelaxation) {
  const double nan = std::nan("");
  expect_refused({{-0.1, 1}}, "prony[0].share");
  expect_refused({{0.5, 1}, {1.1, 2}}, "prony[1].share");
  expect_refused({{nan, 1}}, "prony[0].share");
  expect_refused({{0.5, 0}}, "prony[0].time");
  expect_refused({{0.5, 1}, {0.1, -3}}, "prony[1].time");
  expect_refused({{0.5, HUGE_VAL}}, "prony[0].time");
  expect_refused({{0.6, 1}, {0.5, 2}}, "prony");
  // Ten tenths are one.
  const std::vector<PronyTerm> tenths(10, PronyTerm{0.1, 1});
  EXPECT_NO_THROW(check_prony(tenths));
  EXPECT_GE(PronySeries(tenths, 1).remaining(), 0);
  for (const double step : {0.0, -1.0, nan, HUGE_VAL}) {
    EXPECT_THROW(PronySeries(kMeat, step), InputError);
  }
}

}  // namespace
}  // namespace hvp::tissue::prony_test
