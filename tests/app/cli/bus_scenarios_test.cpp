// What the scenarios of bus and host say is to be seen in them, is.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::bus_scenarios_test {
namespace {

using nlohmann::json;

// Timing only: words do not matter to what is asserted here.
json summary_of(const std::string& name, const std::vector<std::string>& settings, int status) {
  const ScratchDirectory place;
  std::vector<std::string> arguments = {
      "run",   scenario(name).string(), "--out", "a",          "--set", "reference=false",
      "--set", "fidelity.numbers=none", "--set", "frames=200", "--set", "output.pictures=false",
      "--set", "output.trace_frames=0"};
  for (const std::string& setting : settings) {
    arguments.emplace_back("--set");
    arguments.push_back(setting);
  }
  const Ended ended = hvp(place.path(), arguments);
  EXPECT_EQ(ended.status, status) << ended.err;
  return json::parse(read(place.path() / "a/summary.json"));
}

double worst_us(const json& summary) { return summary.at("deadline").at("worst_us"); }

double median_of(const json& summary, const std::string& part, const std::string& phase) {
  for (const json& line : summary.at("latency").at("by_phase")) {
    if (line.at("part") == part && line.at("phase") == phase) return line.at("p50_us");
  }
  return 0;
}

double bus_us(const json& summary) {
  for (const json& line : summary.at("latency").at("by_part")) {
    if (line.at("part") == "bus") return line.at("p50_us");
  }
  return 0;
}

TEST(BusScenarios, DmaHoldsAPeriodThatProgrammedIoMisses) {
  const std::string name = "dma-or-programmed-io.toml";
  const json dma = summary_of(name, {}, 0);
  EXPECT_LT(worst_us(dma), 775);
  EXPECT_EQ(dma.at("deadline").at("misses"), 0);
  const json words = summary_of(name, {"transfer.method=programmed-io"}, 1);
  // 642 reads of a word, 1.09 us each, and as many writes of 0.15 us on the wire.
  EXPECT_GT(bus_us(words) - bus_us(dma), 700);
  EXPECT_EQ(words.at("deadline").at("misses"), 200);
  const json combined = summary_of(name, {"transfer.method=write-combined-io"}, 1);
  EXPECT_LT(bus_us(combined), bus_us(words));
  // A read of STATUS instead of a message that is behind the data.
  const json line = summary_of(name, {"transfer.notification=intx"}, 0);
  EXPECT_GT(worst_us(line), worst_us(dma) + 0.5);
  // Twice the words.
  const json loose = summary_of(name, {"transfer.packed=false"}, 0);
  EXPECT_GT(bus_us(loose), 1.9 * bus_us(dma));
}

TEST(BusScenarios, TheLatencyTimerDecidesHowLongTheDaqWaitsForADma) {
  const std::string name = "daq-beside-dma.toml";
  const auto waiting = [&](const std::vector<std::string>& settings) {
    return median_of(summary_of(name, settings, 0), "bus", "arbitration");
  };
  const double longest = waiting({});
  const double shortest = waiting({"bus.protocol.latency_timer_clocks=16"});
  EXPECT_GT(longest, shortest + 4);
  // Alone on the bus it waits only for what it has posted itself.
  EXPECT_LT(waiting({"bus.pcie.lanes=4"}), shortest);
}

TEST(BusScenarios, AThirdMasterShowsInTheTail) {
  const json two = summary_of("daq-beside-dma.toml", {}, 0);
  const json three = summary_of("daq-beside-dma.toml", {"bus.traffic.bytes=1514"}, 0);
  const auto tail = [](const json& s) {
    return s.at("deadline").at("p99_us").get<double>() -
           s.at("deadline").at("p50_us").get<double>();
  };
  EXPECT_GT(tail(three), tail(two) + 3);
}

TEST(BusScenarios, PcieShrinksTheBusButNotASingleRead) {
  const std::string name = "pcie-msi.toml";
  const json link = summary_of(name, {}, 0);
  EXPECT_LT(bus_us(link), 6);
  const json pci = summary_of("dma-or-programmed-io.toml", {}, 0);
  EXPECT_GT(bus_us(pci), 10 * bus_us(link));
  // Sixteen lanes instead of four: less than two microseconds of 711.
  const json wide = summary_of(name, {"bus.pcie.lanes=16"}, 0);
  EXPECT_NEAR(worst_us(wide), worst_us(link), 2);
  EXPECT_GT(bus_us(summary_of(name, {"transfer.method=programmed-io"}, 1)), 500);
}

TEST(BusScenarios, ARootComplexWithATailShowsInTheTail) {
  const std::string name = "pcie-msi.toml";
  const std::string key = "bus.pcie.root_complex_latencies.host=";
  const json constant = summary_of(name, {}, 0);
  const json narrow = summary_of(name, {key + "xeon-e5"}, 0);
  const json wide = summary_of(name, {key + "xeon-e3"}, 0);
  const auto of = [](const json& s, const char* percentile) {
    return s.at("latency").at("percentiles").at(percentile).get<double>();
  };
  EXPECT_NE(narrow.at("latency"), constant.at("latency"));
  EXPECT_NEAR(of(narrow, "p99_us"), of(constant, "p99_us"), 0.2);
  // b is six requests and a descriptor one more: medians of 1213 instead of 547 ns each.
  EXPECT_GT(of(wide, "p50_us"), of(constant, "p50_us") + 1);
  EXPECT_LT(of(wide, "p50_us"), of(constant, "p50_us") + 6);
  EXPECT_GT(of(wide, "p99_us"), of(wide, "p50_us") + 4);
  const json::array_t effects = wide.at("effects");
  EXPECT_EQ(std::ranges::count(effects, "bus.pcie.root_complex_latencies"), 1);
}

// Samples less what the model counts anyway.
TEST(BusScenarios, MeasuredReadsAreTheUsersLessWhatIsCounted) {
  const ScratchDirectory place;
  write(place.path() / "reads.csv", "time_s,latency_us\n0.1,1.5\n0.2,1.5\n");
  const std::string file = (place.path() / "reads.csv").string();
  const auto reads = [&](const std::string& table) {
    json summary = summary_of("thesis-static.toml", {"bus.read_latencies={" + table + "}"}, 0);
    summary.erase("title");  // names the table
    return summary;
  };
  const std::string measured = "distribution='measured', samples='" + file + "', counted='";
  EXPECT_EQ(reads(measured + "500 ns'"), reads("distribution='constant', mean='1 us'"));
  EXPECT_NE(reads(measured + "0 s'"), reads("distribution='constant', mean='1 us'"));
  write(place.path() / "s.toml", kSmallScene);
  const Ended refused =
      hvp(place.path(), {"run", "s.toml", "--set", "bus.read_latencies={" + measured + "2 us'}"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("bus.read_latencies.counted"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("at most the shortest sample, 1.5 us, found 2 us"), std::string::npos)
      << refused.err;
}

TEST(BusScenarios, MissesGoFromNoneToManyWithTheSpreadOfTheWakeUps) {
  const auto misses = [](const std::string& spread, int status) -> std::int64_t {
    return summary_of("jittery-host.toml", {"host.wake_up.spread=" + spread, "frames=1000"}, status)
        .at("deadline")
        .at("misses");
  };
  const std::int64_t some = misses("3", 1);
  EXPECT_EQ(misses("2", 0), 0);
  EXPECT_GT(some, 10);
  EXPECT_GT(misses("6", 1), 3 * some);
}

}  // namespace
}  // namespace hvp::cli::bus_scenarios_test
