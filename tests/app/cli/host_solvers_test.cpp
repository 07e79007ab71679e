// The host's own solvers and what they cost, as a user asks for them.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::host_solvers_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::string> kNow = {"host.model=desktop-2026"};

class HostSolvers : public ::testing::Test {
 protected:
  Ended with(const std::string& command, const std::vector<std::string>& settings) {
    write(place_.path() / "s.toml", kSmallScene);
    std::vector<std::string> arguments = {command, "s.toml"};
    for (const std::string& setting : settings) {
      arguments.emplace_back("--set");
      arguments.push_back(setting);
    }
    if (command == "run") arguments.insert(arguments.end(), {"--out", "out"});
    return hvp(place_.path(), arguments);
  }
  json figures(std::vector<std::string> settings) {
    settings.insert(settings.end(), kNow.begin(), kNow.end());
    const Ended ended = with("run", settings);
    EXPECT_LE(ended.status, 1) << ended.err;
    return json::parse(read(place_.path() / "out/summary.json"));
  }
  // The forces of all frames, N.
  std::vector<double> forces() {
    const std::vector<std::string> rows = lines(read(place_.path() / "out/frames.csv"));
    std::vector<double> found;
    const std::vector<std::string> names = cells(rows.front());
    for (std::size_t row = 1; row < rows.size(); ++row) {
      const std::vector<std::string> values = cells(rows[row]);
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i].starts_with("force") && names[i].ends_with("_N") && !values[i].empty()) {
          found.push_back(std::stod(values[i]));
        }
      }
    }
    return found;
  }
  void expect_refused(const std::vector<std::string>& settings, const std::string& why) {
    const Ended ended = with("run", settings);
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(why));
  }

  ScratchDirectory place_;

 private:
  static std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> found(1);
    for (const char c : line) {
      if (c == ',') {
        found.emplace_back();
      } else {
        found.back() += c;
      }
    }
    return found;
  }
};

// Forces of every frame, with each kind of contact and with inertia; in single precision to its
// digits.
TEST_F(HostSolvers, AllFindTheForcesOfCholesky) {
  for (const std::vector<std::string>& scene : {std::vector<std::string>{"contact.kind=node"},
                                                {"contact.kind=proxy"},
                                                {"contact.kind=node", "dynamics=true"},
                                                {"contact.kind=proxy", "dynamics=true"}}) {
    std::vector<std::string> exact = scene;
    exact.emplace_back("host.solver=cholesky");
    figures(exact);
    const std::vector<double> expected = forces();
    double largest = 0;
    for (const double force : expected) largest = std::max(largest, std::abs(force));
    ASSERT_GT(largest, 0.01);
    for (const char* solver : {"inverse", "condensed", "superposition"}) {
      if (scene.size() > 1 && std::string(solver) == "superposition") continue;
      for (const char* precision : {"double", "single"}) {
        std::vector<std::string> other = scene;
        other.push_back(std::string("host.solver=") + solver);
        other.push_back(std::string("host.precision=") + precision);
        figures(other);
        const std::vector<double> found = forces();
        ASSERT_EQ(found.size(), expected.size());
        const double near = (precision[0] == 'd' ? 1e-11 : 1e-4) * largest;
        for (std::size_t i = 0; i < found.size(); ++i) {
          ASSERT_NEAR(found[i], expected[i], near) << solver << ' ' << precision << ' ' << i;
        }
      }
    }
  }
}

// Without contact a frame takes what the summary says of a solve, and `hvp explain` of its step.
TEST_F(HostSolvers, TheSummarySaysWhatASolveTakes) {
  for (const char* solver : {"cholesky", "inverse", "condensed"}) {
    const json at_rest = figures({std::string("host.solver=") + solver,
                                  "probe.motion=[{phase='hold', to=['0 mm','0 mm','90 mm'], "
                                  "duration='80 ms'}]",
                                  "probe.start=['0 mm','0 mm','90 mm']", "contact.kind=node"});
    double solve_us = 0;
    for (const json& part : at_rest["attribution"]) {
      if (part["phase"] == "solve") solve_us += part["us"].get<double>();
    }
    EXPECT_NEAR(solve_us, at_rest["host_solve"]["solve_us"].get<double>(), 1e-6) << solver;
    EXPECT_GT(at_rest["host_solve"]["set_up_us"].get<double>(), 0) << solver;
    EXPECT_NEAR(at_rest["set_up_us"].get<double>(),
                at_rest["host_solve"]["set_up_us"].get<double>(), 1e-6)
        << solver;
  }
}

TEST_F(HostSolvers, RefuseWhatTheyCannot) {
  expect_refused({"host.solver=superposition", "dynamics=true"}, "a body with inertia");
  expect_refused({"host.solver=cholesky", "host.precision=single"}, "host.precision");
  expect_refused({"host.model=desktop-2026", "host.sustained_rate=1 Gflop/s"},
                 "belongs to model = \"one-rate\" only");
  expect_refused({"host.solver=cg", "host.solver_rate=1 flop/s"}, "at least 1 Mflop/s");
  expect_refused({"host.solver=cholesky", "host.gpu=true"}, "host.gpu");
  expect_refused({"host.model=measured", "host.processor.level3_size=1 kB"}, "level3_size");
  expect_refused({"host.solver=inverse", "object.mesh.nodes=100000"},
                 "the inverse of 100000 nodes");
}

// To the picosecond: what one thread's solve takes, halved, and four barriers an iteration.
TEST_F(HostSolvers, ThreadsTakeTheirShareOfASolve) {
  const std::vector<std::string> one = {"host.solver=cg", "solver.iterations=20"};
  std::vector<std::string> two = one;
  two.insert(two.end(),
             {"host.threads.count=3", "host.threads.speedup=2", "host.threads.barrier=100 ns"});
  const double alone = figures(one)["host_solve"]["solve_us"];
  const json shared = figures(two);
  const double barriers = (shared["host_solve"]["solve_us"].get<double>() - alone / 2) / 0.1;
  EXPECT_NEAR(barriers, std::round(barriers), 1e-4);
  EXPECT_GE(barriers, 80);
  EXPECT_LE(barriers, 84);
  EXPECT_LT(shared["deadline"]["worst_us"], figures(one)["deadline"]["worst_us"]);
  expect_refused({"host.solver=cholesky", "host.threads=true"},
                 "products with a matrix or an inverse alone");
  expect_refused({"host.solver=cg", "host.threads.count=4"},
                 "4 threads on 4 cores leave the collision process none of its own");
  expect_refused({"host.solver=cg", "host.threads=true", "host.gpu=true"}, "the GPU solves");
}

TEST_F(HostSolvers, ExplainShowsThePrices) {
  const Ended ended = with("explain", {"host.model=thesis-pc"});
  EXPECT_THAT(ended.out, HasSubstr("prices"));
  EXPECT_THAT(ended.out, HasSubstr("463 Mflop/s sparse"));
  EXPECT_THAT(with("explain", {}).out, Not(HasSubstr("prices")));
}

// What is drawn moves the latency and no number; the line about misses is there where it is drawn.
TEST_F(HostSolvers, AGpusLatenciesAreDrawn) {
  const std::vector<std::string> gpu = {"host.solver=inverse", "host.gpu.launch=persistent"};
  const json steady = figures(gpu);
  std::vector<std::string> drawn = gpu;
  drawn.insert(drawn.end(), {"host.gpu.latencies.distribution=uniform",
                             "host.gpu.latencies.maximum=10 us", "seed=3"});
  const json late = figures(drawn);
  const double base = steady["deadline"]["worst_us"];
  EXPECT_GT(late["deadline"]["worst_us"].get<double>(), base + 5);
  EXPECT_LE(late["deadline"]["worst_us"].get<double>(), base + 10 + 1e-6);
  EXPECT_LT(late["deadline"]["p50_us"].get<double>(), base + 9);
  EXPECT_EQ(late["accuracy"], steady["accuracy"]);
  EXPECT_EQ(figures(drawn)["deadline"], late["deadline"]);  // of one seed
  std::vector<std::string> other = drawn;
  other.emplace_back("seed=4");
  EXPECT_NE(figures(other)["deadline"], late["deadline"]);
}

TEST_F(HostSolvers, AShareOfMissesIsSaidWhereTimesAreDrawn) {
  const std::vector<std::string> late = {"host.wake_up.distribution=uniform",
                                         "host.wake_up.maximum=1 us"};
  EXPECT_THAT(with("run", late).out,
              HasSubstr("a miss         in less than 7.22 % of all ticks (95 %"));
  EXPECT_THAT(with("run", {}).out, Not(HasSubstr("a miss")));
  // A period that about half of the frames are within, of those as short.
  std::vector<std::string> brief = late;
  brief.emplace_back("budget.period=93 us");
  with("run", brief);
  const double usual = json::parse(read(place_.path() / "out/summary.json"))["deadline"]["p50_us"];
  std::vector<std::string> often = late;
  often.push_back("budget.period=" + std::to_string(usual) + " us");
  const Ended ended = with("run", often);
  const json miss = json::parse(read(place_.path() / "out/summary.json"))["deadline"]["miss_share"];
  EXPECT_GT(miss["share"].get<double>(), 0);
  EXPECT_LT(miss["low"].get<double>(), miss["share"].get<double>());
  EXPECT_GT(miss["high"].get<double>(), miss["share"].get<double>());
  EXPECT_THAT(ended.out, HasSubstr("of these ticks, in "));
}

TEST_F(HostSolvers, MeasureHostRefusesBeforeItMeasures) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"measure"},
                                                    {"measure", "host", "--out", "x.tml"},
                                                    {"measure", "host", "--out", "none/x.toml"},
                                                    {"measure", "host", "--seconds", "0"}}) {
    const Ended ended = hvp(place_.path(), arguments);
    EXPECT_EQ(ended.status, 2) << ended.err;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_TRUE(names(place_.path()).empty());
  }
}

}  // namespace
}  // namespace hvp::cli::host_solvers_test
