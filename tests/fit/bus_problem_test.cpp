#include "models/fit/bus_problem.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fit/fit.h"
#include "models/link/pci.h"
#include "tests/fit/small_problems.h"

namespace hvp::fit::bus_problem_test {
namespace {

constexpr double kLatency = 0.9e-6;   // s
constexpr double kBandwidth = 105e6;  // bytes/s
constexpr double kNoise = 30e-9;      // s rms

// Sizes in turn, 64 bytes to 4 KiB; every 17th transfer is interrupted for some 20 us.
TransferLog transfers(std::size_t count, bool interrupted, unsigned seed = 1) {
  const std::vector<double> noise = test::noise(count, kNoise, 0, seed);
  TransferLog log{.bytes = {}, .seconds = {}};
  for (std::size_t i = 0; i < count; ++i) {
    log.bytes.push_back(64.0 * static_cast<double>(1U << (i % 7)));
    log.seconds.push_back(kLatency + log.bytes.back() / kBandwidth + noise[i]);
    if (interrupted && i % 17 == 5)
      log.seconds.back() += 20e-6 + 1e-7 * static_cast<double>(i % 50);
  }
  return log;
}

Options robust() {
  Options options;
  options.loss = Loss::cauchy;
  options.hold_out = 0;
  return options;
}

TEST(BusProblem, DerivativesAreThoseOfTheFormula) {
  TransferLog log = transfers(40, false);
  for (std::size_t i = 0; i < 40; ++i) {
    log.direction.push_back(i % 3 == 0 ? link::Direction::read : link::Direction::write);
  }
  const BusProblem problem(log);
  ASSERT_EQ(problem.stretches(), 2U);
  for (std::size_t s = 0; s < 2; ++s) {
    const std::unique_ptr<ceres::CostFunction> cost = problem.cost(s);
    // By hand: −1, and bytes/bandwidth² for its own direction.
    const std::vector<double> at{1e-6, 5e7, 3e-7, 2e8};
    const double* blocks[] = {at.data()};
    std::vector<double> residuals(problem.stretch(s).residuals);
    std::vector<double> jacobian(4 * residuals.size());
    double* jacobians[] = {jacobian.data()};
    ASSERT_TRUE(cost->Evaluate(blocks, residuals.data(), jacobians));
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      EXPECT_EQ(jacobian[4 * i + 2 * s], -1);
      EXPECT_EQ(jacobian[4 * i + 2 * (1 - s)], 0);
      EXPECT_GT(jacobian[4 * i + 2 * s + 1], 0);
      EXPECT_EQ(jacobian[4 * i + 2 * (1 - s) + 1], 0);
    }
  }
}

TEST(BusProblem, FindsLatencyAndBandwidthBesideInterrupts) {
  const Fit fitted = fit(BusProblem(transfers(700, true)), robust());
  EXPECT_EQ(fitted.parameters[0].name, "latency");
  EXPECT_NEAR(fitted.parameters[0].value, kLatency, 0.01 * kLatency);
  EXPECT_NEAR(fitted.parameters[1].value, kBandwidth, 0.002 * kBandwidth);
  EXPECT_EQ(fitted.starts.reached, fitted.starts.tried);
  // Least squares takes the interrupts for latency.
  Options squares = robust();
  squares.loss = Loss::squares;
  EXPECT_GT(fit(BusProblem(transfers(700, true)), squares).parameters[0].value, 1.5 * kLatency);
}

TEST(BusProblem, IntervalsHoldTheTruth) {
  int inside = 0;
  constexpr int kSeeds = 40;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Options options = robust();
    options.starts = 1;
    const Fit fitted = fit(BusProblem(transfers(210, false, seed)), options);
    const Estimate& latency = fitted.parameters[0];
    const Estimate& bandwidth = fitted.parameters[1];
    if (latency.low <= kLatency && kLatency <= latency.high) ++inside;
    if (bandwidth.low <= kBandwidth && kBandwidth <= bandwidth.high) ++inside;
  }
  EXPECT_GE(inside, 70);
}

// A fifth of the transfers are lengthened, by 20 us in the mean: the scale of the robust loss takes
// more than three steps to settle, and before it has, latency is too long by 20 ns and more.
TEST(BusProblem, IntervalsHoldTheTruthBesideManyInterrupts) {
  int inside = 0;
  constexpr int kSeeds = 25;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, 20e-9);
    std::exponential_distribution<double> longer(1 / 20e-6);
    std::bernoulli_distribution interrupted(0.2);
    TransferLog log;
    for (int i = 0; i < 300; ++i) {
      log.bytes.push_back(64 << (i % 10));
      log.seconds.push_back(1.5e-6 + log.bytes.back() / 1e9 + noise(random) +
                            (interrupted(random) ? longer(random) : 0));
    }
    Options options = robust();
    options.starts = 1;
    const Fit fitted = fit(BusProblem(log), options);
    if (fitted.parameters[0].low <= 1.5e-6 && 1.5e-6 <= fitted.parameters[0].high) ++inside;
    EXPECT_NEAR(fitted.parameters[0].value, 1.5e-6, 15e-9) << seed;
  }
  EXPECT_GE(inside, 19);
}

TEST(BusProblem, EachDirectionHasItsOwnLine) {
  TransferLog log = transfers(400, true);
  for (std::size_t i = 0; i < log.bytes.size(); ++i) {
    log.direction.push_back((i / 7) % 2 == 0 ? link::Direction::write : link::Direction::read);
    if (log.direction.back() == link::Direction::read) log.seconds[i] += 2e-6 + log.bytes[i] / 40e6;
  }
  const Fit fitted = fit(BusProblem(log), robust());
  ASSERT_EQ(fitted.parameters.size(), 4U);
  EXPECT_EQ(fitted.parameters[0].name, "read_latency");
  EXPECT_EQ(fitted.parameters[3].name, "write_bandwidth");
  const double read = 1 / (1 / kBandwidth + 1 / 40e6);
  EXPECT_NEAR(fitted.parameters[0].value, kLatency + 2e-6, 0.02e-6);
  EXPECT_NEAR(fitted.parameters[1].value, read, 0.005 * read);
  EXPECT_NEAR(fitted.parameters[2].value, kLatency, 0.02e-6);
  EXPECT_NEAR(fitted.parameters[3].value, kBandwidth, 0.005 * kBandwidth);
}

TEST(BusProblem, TransfersOfOneSizeDoNotGiveTheBandwidth) {
  TransferLog log = transfers(100, false);
  for (std::size_t i = 0; i < 100; ++i) {
    log.seconds[i] += (512 - log.bytes[i]) / kBandwidth;
    log.bytes[i] = 512;
  }
  const Fit fitted = fit(BusProblem(log), robust());
  EXPECT_FALSE(fitted.parameters[1].identifiable);
  EXPECT_EQ(fitted.parameters[1].remedy, "transfers of several sizes");
}

TEST(BusProblem, TakesRowsInTheOrderInWhichTheyBegan) {
  TransferLog log = transfers(30, false);
  std::sort(log.bytes.begin(), log.bytes.end());
  EXPECT_EQ(BusProblem(log).warnings().size(), 1U);
  for (std::size_t i = 0; i < 30; ++i) log.begun.push_back(static_cast<double>((7 * i) % 30));
  const BusProblem problem(log);
  EXPECT_TRUE(problem.warnings().empty());
  std::vector<double> residuals(30);
  const double at[] = {0, 1e13};
  const double* blocks[] = {at};
  ASSERT_TRUE(problem.cost(0)->Evaluate(blocks, residuals.data(), nullptr));
  // Begun second of all: row 13, since 7·13 = 91 = 1 of 30.
  EXPECT_NEAR(residuals[1], log.seconds[13], 1e-9);
}

TEST(BusProblem, RefusesWhatAreNoTransfers) {
  const auto refused = [](const TransferLog& log, const std::string& column) {
    try {
      const BusProblem problem(log);
      ADD_FAILURE() << "not refused: " << column;
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).rfind(column, 0), 0U) << e.what();
    }
  };
  refused(transfers(5, false), "bytes");
  TransferLog log = transfers(20, false);
  log.bytes[3] = 0;
  refused(log, "bytes");
  log = transfers(20, false);
  log.seconds[3] = -1e-6;
  refused(log, "time");
  log = transfers(20, false);
  for (double& t : log.seconds) t *= 1e9;
  refused(log, "time");
  log = transfers(20, false);
  log.seconds.assign(20, 1e-6);
  refused(log, "time");
  log = transfers(20, false);
  log.seconds.pop_back();
  refused(log, "time");
  log = transfers(20, false);
  log.direction.assign(20, link::Direction::read);
  log.direction[4] = link::Direction::write;
  refused(log, "bytes");
}

// The model measured by itself: times of whole bursts give its own settings back.
TEST(BusPci, TheModelsOwnTimesGiveItsSettings) {
  for (const link::PciKind kind : {link::PciKind::pci_32_33, link::PciKind::pci_x_133}) {
    link::Pci pci;
    pci.kind = kind;
    TransferLog log{.bytes = {}, .seconds = {}};
    const std::vector<double> noise = test::noise(400, 1e-9, 0, 3);
    for (std::size_t i = 0; i < 400; ++i) {
      const std::int64_t bytes = 64 * (1 + static_cast<std::int64_t>(i * 13 % 64));
      const bool read = i % 2 == 0;
      const std::int64_t ps = read ? pci.read_ps(bytes) : pci.write_ps(bytes);
      log.bytes.push_back(static_cast<double>(bytes));
      log.seconds.push_back(static_cast<double>(ps) * 1e-12 + noise[i]);
      log.direction.push_back(read ? link::Direction::read : link::Direction::write);
    }
    const Fit fitted = fit(BusProblem(log), robust());
    const Link read{fitted.parameters[0].value, fitted.parameters[1].value};
    const Link write{fitted.parameters[2].value, fitted.parameters[3].value};
    EXPECT_NEAR(read.bandwidth, read_bandwidth(pci), 1e-3 * read.bandwidth);
    EXPECT_NEAR(write.latency_s, pci.write_latency_s, 1e-9);
    const NearestPci nearest = nearest_pci(pci, read, write);
    EXPECT_EQ(nearest.pci.kind, pci.kind);
    EXPECT_EQ(nearest.pci.burst_bytes, pci.burst_bytes);
    EXPECT_EQ(nearest.pci.overhead_clocks, pci.overhead_clocks);
    EXPECT_EQ(nearest.pci.read_wait_clocks, pci.read_wait_clocks);
    EXPECT_NEAR(nearest.pci.read_latency_s, pci.read_latency_s, 2e-9);
    EXPECT_TRUE(nearest.warnings.empty());
  }
}

TEST(BusPci, AnotherBandwidthChangesTheFewestKeys) {
  const link::Pci base;
  link::Pci other = base;
  other.overhead_clocks = 9;
  const NearestPci nearest = nearest_pci(base, {}, Link{0.2e-6, write_bandwidth(other)});
  EXPECT_EQ(nearest.pci.kind, base.kind);
  EXPECT_EQ(nearest.pci.burst_bytes, base.burst_bytes);
  EXPECT_EQ(nearest.pci.overhead_clocks, 9);
  EXPECT_EQ(nearest.pci.read_latency_s, base.read_latency_s);
  EXPECT_EQ(nearest.pci.write_latency_s, 0.2e-6);
  EXPECT_FALSE(nearest.read_deviation);
  EXPECT_NEAR(*nearest.write_deviation, 0, 1e-12);
  nearest.pci.check();
}

TEST(BusPci, SaysThatItIsNoConventionalPci) {
  const NearestPci nearest = nearest_pci({}, {}, Link{2e-3, 3e9});
  EXPECT_LT(*nearest.write_deviation, -0.6);
  ASSERT_EQ(nearest.warnings.size(), 2U);
  EXPECT_NE(nearest.warnings[0].find("write_latency"), std::string::npos);
  EXPECT_NE(nearest.warnings[1].find("3000 MB/s"), std::string::npos);
}

}  // namespace
}  // namespace hvp::fit::bus_problem_test
