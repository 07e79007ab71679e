// The VCD file as a viewer reads it: names, times and values.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/vp/engine/engine_systems.h"
#include "vp/fpga/engine/engine_trace.h"

namespace hvp::vp::engine::trace_test {
namespace {

// Value changes by full name, as (time, value); IEEE 1364 section 18.
class Vcd {
 public:
  using Changes = std::vector<std::pair<std::int64_t, double>>;

  explicit Vcd(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::string token;
    std::vector<std::string> scope;
    while (in >> token) {
      if (token == "$timescale") {
        std::getline(in, timescale, '$');
      } else if (token == "$scope") {
        std::string kind, name;
        in >> kind >> name;
        scope.push_back(name);
      } else if (token == "$upscope") {
        scope.pop_back();
      } else if (token == "$var") {
        std::string type, width, id, name;
        in >> type >> width >> id >> name;
        std::string full;
        for (const std::string& part : scope) full += part + ".";
        name_[id] = full + name;
        changes[full + name];
      } else if (token == "$enddefinitions") {
        break;
      }
    }
    std::int64_t time = 0;
    while (in >> token) {
      if (token[0] == '#') {
        time = std::stoll(token.substr(1));
      } else if (token[0] == 'b') {
        std::string id;
        in >> id;
        add(id, time, signed_value(token.substr(1)));
      } else if (token[0] == 'r') {
        std::string id;
        in >> id;
        add(id, time, std::stod(token.substr(1)));
      } else if (token[0] == '0' || token[0] == '1') {
        add(token.substr(1), time, token[0] - '0');
      }
    }
  }

  // The last value at a time.
  double at(const std::string& name, std::int64_t time) const {
    double value = std::nan("");
    for (const auto& [when, what] : changes.at(name)) {
      if (when <= time) value = what;
    }
    return value;
  }

  std::string timescale;
  std::map<std::string, Changes> changes;

 private:
  static double signed_value(const std::string& bits) {
    // Shortened from 64 or 32 bits: the leading bit stands for those that are left out.
    std::uint64_t value =
        bits[0] == '1' && (bits.size() == 32 || bits.size() == 64) ? ~std::uint64_t{0} : 0;
    for (const char bit : bits) value = value << 1U | (bit == '1' ? 1U : 0U);
    return static_cast<double>(static_cast<std::int64_t>(value));
  }
  void add(const std::string& id, std::int64_t time, double value) {
    if (name_.contains(id)) changes[name_[id]].emplace_back(time, value);
  }
  std::map<std::string, std::string> name_;
};

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
  const Vcd vcd(path.string() + ".vcd");
  std::filesystem::remove(path.string() + ".vcd");
  EXPECT_NE(vcd.timescale.find("1 ps"), std::string::npos) << vcd.timescale;

  const std::string top = "SystemC.engine.";
  const Vcd::Changes& clock = vcd.changes.at(top + "clock_edge");
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
  const Vcd::Changes& residual = vcd.changes.at(top + "vector_unit.r_x_value");
  EXPECT_GT(residual.size(), 10U);
  for (const auto& [time, worth] : residual) {
    EXPECT_EQ(vcd.at(top + "vector_unit.z_x_value", time),
              vcd.at(top + "vector_unit.r_x_value", time));
  }
}

}  // namespace
}  // namespace hvp::vp::engine::trace_test
