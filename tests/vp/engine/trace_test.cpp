// The VCD file as a viewer reads it: names, times and values.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/vp/engine/engine_systems.h"
#include "tests/vp/engine/value_changes.h"
#include "vp/fpga/engine/engine_trace.h"

namespace hvp::vp::engine::trace_test {
namespace {

TEST(Trace, ShowsTheJobsOfItsWindowWithReadableNumbers) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("hvp_engine_trace_" + std::to_string(::getpid()));
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(2, 2, 2), 12);
  fixed::Settings settings;
  settings.iterations = 3;
  std::vector<std::pair<std::int64_t, std::int64_t>> times;  // of each job, ps
  Scalars scalars;
  std::vector<std::int32_t> x(static_cast<std::size_t>(matrix.rows()));
  {
    CycleEngine engine("engine", {});
    const EngineTrace trace("trace", engine, path.string(), {[&] { return engine.jobs(); }, 2, 2});
    engine.load(matrix, settings);
    engine.write_b(test::random_words(matrix.rows(), 3000, 5));
    for (int job = 1; job <= 3; ++job) {
      const auto now = [] { return static_cast<std::int64_t>(sc_core::sc_time_stamp().value()); };
      times.emplace_back(now(), 0);
      engine.start_solve(settings);
      sc_core::sc_start();
      times.back().second = now();
      if (job == 2) {
        scalars = engine.sequencer().scalars();
        engine.read_x(x);
      }
    }
  }
  const test::ValueChanges vcd = test::read_vcd(path.string() + ".vcd");
  std::filesystem::remove(path.string() + ".vcd");
  EXPECT_NE(vcd.timescale.find("1 ps"), std::string::npos) << vcd.timescale;

  const std::string top = "SystemC.engine.";
  const test::ValueChanges::Changes& clock = vcd.changes.at(top + "clock_edge");
  // Every edge of the second job, and the value that a file begins with.
  const auto [begin, end] = times[1];
  EXPECT_EQ(static_cast<std::int64_t>(clock.size()), 1 + (end - begin) / 10'000);
  for (const auto& [name, changes] : vcd.changes) {
    for (const auto& [time, value] : changes) {
      if (time == 0) continue;
      EXPECT_TRUE(time > begin && time <= end) << name << " at " << time;
    }
  }
  // As many products as iterations and one of the set-up; the states follow one another.
  int products = 0;
  for (const auto& [time, value] : vcd.changes.at(top + "sequencer.state.product")) {
    if (value == 1) ++products;
  }
  EXPECT_EQ(products, 3);
  EXPECT_EQ(vcd.at(top + "sequencer.iteration", end), 3);
  EXPECT_EQ(vcd.at(top + "job", end), 2);
  EXPECT_EQ(vcd.at(top + "frame", end), 2);
  // When the job is over, x goes into the copies of d.
  EXPECT_EQ(vcd.changes.at(top + "sequencer.state.copy").size(), 3U);

  const double alpha = std::ldexp(scalars.alpha.mantissa, scalars.alpha.exponent);
  EXPECT_NEAR(vcd.at(top + "sequencer.alpha_value", end), alpha, 1e-5 * alpha);
  const auto node = static_cast<std::size_t>(vcd.at(top + "vector_unit.written_node", end));
  EXPECT_EQ(vcd.at(top + "vector_unit.x_x_word", end), x[3 * node]);
  const double word = vcd.at(top + "vector_unit.r_x_word", end);
  const double value = std::ldexp(word, -scalars.r_exponent);
  EXPECT_NE(word, 0);
  EXPECT_NEAR(vcd.at(top + "vector_unit.r_x_value", end), value, 1e-5 * std::abs(value));
  // Without a preconditioner z is r, the same word of the same worth at every clock.
  const test::ValueChanges::Changes& residual = vcd.changes.at(top + "vector_unit.r_x_value");
  EXPECT_GT(residual.size(), 10U);
  for (const auto& [time, worth] : residual) {
    EXPECT_EQ(vcd.at(top + "vector_unit.z_x_value", time),
              vcd.at(top + "vector_unit.r_x_value", time));
  }
}

}  // namespace
}  // namespace hvp::vp::engine::trace_test
