// The matrix in external memory, and its refresh, from the scenario to the results.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kMemory = "accelerator.external_memory=true";
const std::string kRefresh = "accelerator.external_memory.refresh=true";
constexpr std::int64_t kClock_ps = 10'000;

class ExternalMemory : public ::testing::Test {
 protected:
  ExternalMemory() { write(place_.path() / "s.toml", kSmallScene); }

  Ended with(const std::string& command, const std::string& setting) {
    std::vector<std::string> arguments = {command, "s.toml", "--set", setting};
    if (command == "run") arguments.insert(arguments.end(), {"--out", "out"});
    return hvp(place_.path(), arguments);
  }
  json accelerator() {
    return json::parse(read(place_.path() / "out/summary.json")).at("accelerator");
  }
  // How long the FPGA worked for each frame, in ps.
  std::vector<std::int64_t> solves() {
    std::vector<std::int64_t> times;
    std::size_t column = 0;
    for (const std::string& line : lines(read(place_.path() / "out/frames.csv"))) {
      std::istringstream cells(line);
      std::string cell;
      for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
        if (line.starts_with("frame") && cell == "fpga_us") column = i;
        if (line.starts_with("frame") || i != column) continue;
        std::erase(cell, '.');  // six digits of a microsecond
        times.push_back(std::stoll(cell));
      }
    }
    return times;
  }

  ScratchDirectory place_;
};

TEST_F(ExternalMemory, ItsRefreshMakesEverySolveLonger) {
  ASSERT_LE(with("run", kMemory).status, 1);
  const json streamed = accelerator();
  const std::vector<std::int64_t> without = solves();
  EXPECT_FALSE(streamed.contains("refresh_cycles"));
  ASSERT_LE(with("run", kRefresh).status, 1);
  const json refreshed = accelerator();
  const std::vector<std::int64_t> pausing = solves();

  const auto more = refreshed.at("refresh_cycles").get<std::int64_t>();
  EXPECT_GT(more, 0);
  EXPECT_EQ(refreshed.at("solve_cycles").get<std::int64_t>(),
            streamed.at("solve_cycles").get<std::int64_t>() + more);
  EXPECT_EQ(refreshed.at("refresh_pauses").get<std::int64_t>(),
            (more * kClock_ps + 127'499) / 127'500);
  ASSERT_EQ(pausing.size(), 40U);
  ASSERT_EQ(without.size(), 40U);
  for (std::size_t i = 0; i < pausing.size(); ++i) {
    EXPECT_EQ(pausing[i], without[i] + more * kClock_ps) << "frame " << i;
  }
}

TEST_F(ExternalMemory, ItsRefreshIsPricedByExplain) {
  const std::string row = "while external memory refreshes";
  EXPECT_THAT(with("explain", kMemory).out, Not(HasSubstr(row)));
  EXPECT_THAT(with("explain", kRefresh).out, HasSubstr(row));
}

TEST_F(ExternalMemory, ARefreshThatNeverEndsIsRefusedByItsKey) {
  const Ended ended = with("run", "accelerator.external_memory.refresh.pause=5us");
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("accelerator.external_memory.refresh.pause"));
  EXPECT_EQ(lines(ended.err).size(), 1U);
}

}  // namespace
}  // namespace hvp::cli
