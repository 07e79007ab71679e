// The ports of engine.sv that are up for a clock: no program here goes by `finished`, for which
// hardware around the engine waits.
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/engine/random_systems.h"
#include "tests/vp/engine/rtl_pair.h"

namespace hvp::vp::rtl::rtl_ports_test {
namespace {

using fixed::Settings;
using test::Random;
using test::settings_of;
using test::words;

constexpr std::int64_t kMostClocks = 1'000'000;  // a solve has ended by then

// An RTL engine whose port is looked at behind each edge.
class Watched {
 public:
  Watched() : engine_(kEngineThesis, test::architecture_of(kEngineThesis)) {
    engine_.watch([this] { look(); });
  }

  RtlEngine& engine() { return engine_; }
  // Edges behind which the port was up, since the last time.
  int ends() { return std::exchange(ends_, 0); }
  int iterations() { return std::exchange(iterations_, 0); }

  void load(const fixed::QuantisedMatrix& matrix, const Settings& settings, Random& random) {
    engine_.load(matrix, settings);
    engine_.write_b(words(matrix.rows(), settings.vector_bits, random));
    before_ = 0;
  }
  // Whatever was about to happen.
  void reset() {
    EnginePorts& ports = engine_.model().ports;
    ports.reset = true;
    for (int i = 0; i < 2; ++i) {
      engine_.model().tick();
      EXPECT_FALSE(ports.finished);
      EXPECT_FALSE(ports.iteration_made);
    }
    ports.reset = false;
    before_ = ports.state;
  }
  void start(const Settings& settings) {
    engine_.start_solve(settings);
    before_ = engine_.ports().state;
    EXPECT_FALSE(engine_.ports().finished);
  }

 private:
  void look() {
    const EnginePorts& ports = engine_.ports();
    constexpr auto kIdle = static_cast<int>(engine::State::idle);
    constexpr auto kCopy = static_cast<int>(engine::State::copy);
    const bool ended = before_ != kIdle && before_ != kCopy && ports.state == kIdle;
    EXPECT_EQ(ports.finished, ended) << "behind state " << before_;
    constexpr auto kDirection = static_cast<int>(engine::State::direction);
    EXPECT_FALSE(ports.iteration_made && (before_ != kDirection || ports.state == kDirection));
    iterations_ += ports.iteration_made ? 1 : 0;
    ends_ += ports.finished ? 1 : 0;
    before_ = ports.state;
  }

  RtlEngine engine_;
  int before_ = 0;
  int ends_ = 0;
  int iterations_ = 0;
};

fixed::QuantisedMatrix definite_matrix(Random& random) {
  return hvp::test::random_matrix(20, 4, kEngineThesis.matrix_bits, random);
}

TEST(RtlPorts, FinishedIsUpBehindTheLastIteration) {
  Watched watched;
  Random random(1);
  Settings settings = settings_of(kEngineThesis);
  settings.iterations = 3;
  watched.load(definite_matrix(random), settings, random);
  for (int solve = 0; solve < 2; ++solve) {
    watched.start(settings);
    watched.engine().run_until(kMostClocks);
    EXPECT_EQ(watched.engine().report().iterations, 3);
    EXPECT_EQ(watched.iterations(), 3);
    EXPECT_EQ(watched.ends(), 1);
    watched.engine().start_copy();
    watched.engine().end_copy();
    EXPECT_EQ(watched.ends(), 0);
  }
}

TEST(RtlPorts, FinishedIsUpBehindTheStopTest) {
  Watched watched;
  Random random(2);
  Settings settings = settings_of(kEngineThesis);
  settings.stop_residual = 0.5;
  watched.load(definite_matrix(random), settings, random);
  watched.start(settings);
  watched.engine().run_until(kMostClocks);
  EXPECT_TRUE(watched.engine().report().reached);
  EXPECT_EQ(watched.ends(), 1);
}

TEST(RtlPorts, FinishedIsUpBehindABreakdown) {
  Watched watched;
  Random random(3);
  const Settings settings = settings_of(kEngineThesis);
  fixed::QuantisedMatrix matrix = definite_matrix(random);
  for (std::int32_t& word : matrix.value) word = -word;
  watched.load(matrix, settings, random);
  watched.start(settings);
  watched.engine().run_until(kMostClocks);
  EXPECT_EQ(watched.engine().report().breakdowns, 1);
  EXPECT_EQ(watched.ends(), 1);
}

TEST(RtlPorts, FinishedStaysDownBehindAnAbortAndAChangeOfTheMatrix) {
  Watched watched;
  Random random(4);
  Settings settings = settings_of(kEngineThesis);
  settings.iterations = 2;
  watched.load(definite_matrix(random), settings, random);
  // Each clock of the last passes, and some of those before.
  for (std::int64_t clocks = 1; clocks < 2000; clocks += clocks < 700 ? 9 : 1) {
    watched.start(settings);
    watched.engine().run_until(clocks);
    if (watched.engine().idle()) break;
    watched.reset();
    watched.engine().abort();
    watched.engine().start_copy();
    watched.engine().end_copy();
    watched.engine().constrain(static_cast<int>(clocks) % 20, 77);
    EXPECT_EQ(watched.ends(), 0);
  }
  EXPECT_TRUE(watched.engine().idle());
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_ports_test
