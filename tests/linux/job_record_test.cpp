#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// `hvp run --record-jobs`: another host, which knows nothing of bodies and contacts, has the jobs
// of the record solved, and gets the U of the run, bit for bit. That host is servo_in_process here,
// and a kernel in linux_test.py.
namespace hvp::cli::job_record_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

struct Recorded {
  std::string name;
  std::string scenario;  // empty: kSmallScene
  std::vector<std::string> settings;
  std::uint32_t jobs;
};

void PrintTo(const Recorded& recorded, std::ostream* out) { *out << recorded.name; }

class JobRecord : public ::testing::TestWithParam<Recorded> {
 protected:
  Ended run(const Recorded& what) {
    fs::path file = what.scenario.empty() ? place_.path() / "s.toml" : scenario(what.scenario);
    if (what.scenario.empty()) write(file, kSmallScene);
    std::vector<std::string> words = {"run",
                                      file.string(),
                                      "--record-jobs",
                                      "--out",
                                      "out",
                                      "--set",
                                      "reference=false",
                                      "--set",
                                      "output.pictures=false"};
    for (const std::string& setting : what.settings) words.insert(words.end(), {"--set", setting});
    scenario_ = file;
    return hvp(place_.path(), words);
  }
  int solve_again() const {
    return std::system(fmt::format("{} {} {} {}", HVP_SERVO_IN_PROCESS, scenario_.string(),
                                   (out() / "jobs.hvpf").string(), (out() / "again").string())
                           .c_str());
  }
  fs::path out() const { return place_.path() / "out"; }
  std::vector<std::uint32_t> words(const std::string& name) const {
    const std::string bytes = read(out() / name);
    std::vector<std::uint32_t> words(bytes.size() / 4);
    std::memcpy(words.data(), bytes.data(), 4 * words.size());
    return words;
  }
  // How many of the jobs in jobs.hvpu have a U that is not zero.
  int touched() const {
    const std::vector<std::uint32_t> all = words("jobs.hvpu");
    const std::size_t n = 3 * std::size_t{all.at(2)};
    int touched = 0;
    for (std::size_t at = 4; at < all.size(); at += 12 + n) {
      for (std::size_t i = 0; i < n; ++i) {
        if (all.at(at + 12 + i) == 0) continue;
        ++touched;
        break;
      }
    }
    return touched;
  }

 private:
  ScratchDirectory place_;
  fs::path scenario_;
};

TEST_P(JobRecord, IsSolvedAgainToTheBit) {
  const Ended ended = run(GetParam());
  ASSERT_LE(ended.status, 1) << ended.err;
  ASSERT_EQ(words("jobs.hvpf").at(4), GetParam().jobs) << ended.err;
  EXPECT_EQ(words("jobs.hvpu").at(3), GetParam().jobs);
  EXPECT_GT(touched(), 4);
  ASSERT_EQ(solve_again(), 0);
  EXPECT_TRUE(read(out() / "jobs.hvpu") == read(out() / "again"));
}

// The board of the second solve is that of the file, without the settings: what is set here is the
// host's and the solver's, which the record brings.
INSTANTIATE_TEST_SUITE_P(
    Runs, JobRecord,
    ::testing::Values(Recorded{"StaticBox", "", {}, 40},
                      Recorded{"DynamicBody", "thesis.toml", {"frames=200"}, 200},
                      Recorded{"MovingContact", "bean.toml", {"frames=200"}, 200},
                      Recorded{
                          "GlidingContact", "bean.toml", {"frames=200", "contact.kind=proxy"}, 71},
                      Recorded{"TwoProbesRefined", "pinch.toml", {"frames=200"}, 116},
                      Recorded{"FromZero", "", {"solver.start=zero"}, 40},
                      Recorded{"NeverScaled", "", {"solver.dynamic_scaling=false"}, 40},
                      Recorded{"Pipelined", "", {"host.pipeline_depth=1"}, 40}),
    [](const auto& of) { return of.param.name; });

// A board that is set up again has been asked what the file has no place for.
TEST_F(JobRecord, EndsBeforeAFaultAndSaysSo) {
  const Ended ended = run({"", "faulty-board.toml", {}, 0});
  ASSERT_EQ(ended.status, 1) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("jobs.hvpf has the first 300 jobs: "));
  EXPECT_EQ(words("jobs.hvpf").at(4), 300U);
  EXPECT_EQ(words("jobs.hvpu").at(3), 300U);
}

TEST_F(JobRecord, SaysWhenThereWasNoJob) {
  const Ended ended = run({"", "pinch.toml", {"frames=50"}, 0});
  EXPECT_THAT(ended.err, HasSubstr("jobs.hvpf has the first 0 jobs: no job was solved"));
}

TEST_F(JobRecord, NeedsABoardWithWords) {
  for (const auto& [name, setting, line] :
       {std::tuple("wall.toml", "title=wall", "wall: the scenario has a wall and no board"),
        std::tuple("thesis.toml", "fidelity.numbers=none", "fidelity.numbers")}) {
    const Ended ended = run({"", name, {setting}, 0});
    EXPECT_EQ(ended.status, 2);
    EXPECT_THAT(ended.err, HasSubstr(line));
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_FALSE(fs::exists(out()));
  }
}

}  // namespace
}  // namespace hvp::cli::job_record_test
