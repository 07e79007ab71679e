// Fits of a link and of a host.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "models/link/pcie.h"
#include "tests/app/cli/fit_command.h"

namespace hvp::cli::fit_links_test {
namespace {

using nlohmann::json;
using test::FitCommand;
using ::testing::HasSubstr;
using ::testing::Not;

// Transfers over a link of so many MB/s, with a little jitter.
std::string transfers(double mb_s) {
  std::string text = "bytes,time_us\n";
  for (int i = 0; i < 70; ++i) {
    const int bytes = 64 << (i % 7);
    const double jitter = 0.01 * ((i * 37) % 11 - 5);
    text += std::to_string(bytes) + "," + std::to_string(0.9 + bytes / mb_s + jitter) + "\n";
  }
  return text;
}

// The settings of another bus are no settings of this one.
TEST_F(FitCommand, WritesNoBusForALinkThatIsFarFasterThanAny) {
  write("link.csv", transfers(3400));
  const Ended link = fit({"link.csv", "--model", "bus", "--out", "link.toml"});
  EXPECT_THAT(link.out + link.err, HasSubstr("no kind of [bus] is as fast"));
  const Ended explained =
      hvp(place_.path(), {"explain", scenario("thesis.toml").string(), "--include", "link.toml"});
  EXPECT_EQ(explained.status, 0) << explained.err;
  EXPECT_THAT(read(place_.path() / "link.toml"), Not(HasSubstr("pci-x-133")));
}

// A board's reads and writes of the host's memory, by its own clock.
TEST_F(FitCommand, FindsALinkOfPciExpress) {
  link::Pcie truth;
  truth.generation = link::PcieGeneration::gen2;
  truth.lanes = 8;
  truth.outstanding_reads = 5;
  truth.root_complex_latency_s = 2e-6;
  std::string log = "bytes,time_ns,write_count\n";
  for (std::int64_t bytes = 64; bytes < 300'000; bytes = bytes * 3 / 2) {
    log += fmt::format("{},{},0\n{},{},1\n", bytes,
                       1e-3 * static_cast<double>(truth.read_ps(link::PcieSide::device, bytes)),
                       bytes, 1e-3 * static_cast<double>(truth.posted_write_ps(bytes)));
  }
  write("pcie.csv", log);
  const Ended ended =
      fit({"pcie.csv", "--model", "bus", "--set", "link=pcie", "--out", "pcie.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const std::string table = read(place_.path() / "pcie.toml");
  EXPECT_THAT(table, HasSubstr("[bus.pcie]"));
  EXPECT_THAT(table, HasSubstr("outstanding_reads = 5  # from read_bandwidth, 95 %: "));
  EXPECT_THAT(ended.out, HasSubstr("half of the sizes' reads are within"));
  EXPECT_THAT(ended.out, HasSubstr("half of the sizes' writes are within"));
  EXPECT_THAT(ended.out, HasSubstr("\n  write_latency "));
  EXPECT_THAT(table, HasSubstr("link_latency = "));
  // The scenario's board then moves its data as fast as the true link's.
  const auto worst = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"run",   scenario("thesis-static.toml").string(),
                                          "--out", "out",
                                          "--set", "transfer.method=dma",
                                          "--set", "frames=5",
                                          "--set", "output.pictures=false",
                                          "--set", "bus.posted_writes=false"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Ended ran = hvp(place_.path(), arguments);
    EXPECT_EQ(ran.status, 0) << ran.err;
    return json::parse(read(place_.path() / "out/summary.json"))
        .at("deadline")
        .at("worst_us")
        .get<double>();
  };
  const double with_truth =
      worst({"--set", "bus.pcie.generation=gen2", "--set", "bus.pcie.lanes=8", "--set",
             "bus.pcie.outstanding_reads=5", "--set", "bus.pcie.root_complex_latency=2 us"});
  EXPECT_NEAR(worst({"--include", "pcie.toml"}), with_truth, 0.5);
  write(
      "one.csv", "bytes,time_ns\n" + [] {
        std::string rows;
        for (int i = 0; i < 12; ++i) rows += fmt::format("64,{}\n", 900 + i);
        return rows;
      }());
  expect_refused(fit({"one.csv", "--model", "bus", "--set", "link=pcie"}), "all of one size");
  expect_refused(fit({"pcie.csv", "--model", "bus", "--set", "link=usb"}), "pci");
}

// A log of writes alone is of writes; one of reads and one of writes are a link of both. Logs of
// one name get their folders.
TEST_F(FitCommand, LogsOfOneDirectionAreOfThat) {
  const auto log = [&](const std::string& folder, int write_count, double latency_us) {
    std::filesystem::create_directories(place_.path() / folder);
    std::string text = "bytes,time_us,write_count\n";
    for (int i = 0; i < 40; ++i) {
      const int bytes = 64 << (i % 10);
      text += fmt::format("{},{:.6f},{}\n", bytes, latency_us + bytes / 1500.0 + 1e-3 * (i % 7),
                          write_count);
    }
    write(folder + "/log.csv", text);
  };
  log("reads", 0, 1.2);
  log("writes", 1, 0.4);
  const Ended writes = fit(
      {"writes/log.csv", "--model", "bus", "--json", "--set", "link=pcie", "--out", "writes.toml"});
  ASSERT_EQ(writes.status, 0) << writes.err;
  EXPECT_NEAR(parameter(json::parse(writes.out), "write_latency").at("value"), 0.403e-6, 3e-9);
  EXPECT_THAT(writes.out, Not(HasSubstr("nothing can be had")));
  const std::string table = read(place_.path() / "writes.toml");
  EXPECT_THAT(table, HasSubstr("link_latency = "));
  EXPECT_THAT(table, Not(HasSubstr("outstanding_reads")));

  const Ended both = fit({"reads/log.csv", "writes/log.csv", "--model", "bus", "--set", "link=pcie",
                          "--out", "both.toml"});
  ASSERT_EQ(both.status, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("bus fitted to reads/log.csv, writes/log.csv"));
  EXPECT_THAT(both.out, HasSubstr("only reads/log.csv gives read_latency, read_bandwidth"));
  EXPECT_THAT(both.out, HasSubstr("only writes/log.csv gives write_latency, write_bandwidth"));
  EXPECT_THAT(read(place_.path() / "both.toml"), HasSubstr("link_latency = "));
  EXPECT_THAT(read(place_.path() / "both.toml"), HasSubstr("root_complex_latency = "));
}

TEST_F(FitCommand, FindsABusAndAHost) {
  write("bus.csv", transfers(85));
  const Ended bus = fit({"bus.csv", "--model", "bus", "--json", "--out", "bus.toml"});
  ASSERT_EQ(bus.status, 0) << bus.err;
  EXPECT_NEAR(parameter(json::parse(bus.out), "bandwidth").at("value"), 85e6, 1e5);
  EXPECT_NEAR(parameter(json::parse(bus.out), "latency").at("value"), 0.9e-6, 2e-8);

  std::string histogram = "# Histogram\n";
  for (int us = 1; us < 60; ++us) {
    const double z = std::log((us + 0.5) / 8.0) / std::log(1.7);
    histogram += std::to_string(us) + " " +
                 std::to_string(static_cast<int>(1e5 / (us + 0.5) * std::exp(-0.5 * z * z))) + "\n";
  }
  write("host.txt", histogram);
  const Ended host = fit({"host.txt", "--model", "host", "--json", "--out", "host.toml"});
  ASSERT_EQ(host.status, 0) << host.err;
  EXPECT_NEAR(parameter(json::parse(host.out), "spread").at("value"), 1.7, 0.05);
  const Ended explained = hvp(place_.path(), {"explain", scenario("thesis.toml").string(),
                                              "--include", "bus.toml", "--include", "host.toml"});
  EXPECT_EQ(explained.status, 0) << explained.err;
}

// The latencies themselves with their tail, in a table elsewhere than the log.
TEST_F(FitCommand, FindsTheTailOfAHost) {
  std::string histogram = "latency_us,count\n4,9000000\n5,900000\n";
  for (int us = 20; us < 400; ++us) {
    const double share = std::exp(-(us - 20) / 30.0) - std::exp(-(us - 19) / 30.0);
    histogram += std::to_string(us) + "," + std::to_string(std::lround(1e5 * share)) + "\n";
  }
  write("host.csv", histogram);
  std::filesystem::create_directory(place_.path() / "fits");
  const Ended host = fit({"host.csv", "--model", "host", "--set", "distribution=measured", "--set",
                          "tail_share=0.02", "--json", "--out", "fits/tail.toml"});
  ASSERT_EQ(host.status, 0) << host.err;
  const json found = json::parse(host.out);
  EXPECT_NEAR(parameter(found, "tail_scale").at("value"), 30e-6, 3e-6);
  EXPECT_NEAR(parameter(found, "tail_shape").at("value"), 0, 0.1);
  // e^(−t/30) of a hundredth is a millionth.
  EXPECT_NEAR(parameter(found, "exceeded_1e-6").at("value"), (20 + 30 * std::log(1e4)) * 1e-6,
              60e-6);
  EXPECT_THAT(read(place_.path() / "fits/tail.toml"), HasSubstr("samples = \"../host.csv\""));
  const Ended explained = hvp(
      place_.path(), {"explain", scenario("thesis.toml").string(), "--include", "fits/tail.toml"});
  EXPECT_EQ(explained.status, 0) << explained.err;

  const Ended share = fit({"host.csv", "--model", "host", "--set", "tail_share=0.02"});
  EXPECT_EQ(share.status, 2);
  const Ended few = fit({"host.csv", "--model", "host", "--set", "distribution=measured", "--set",
                         "tail_share=0.000001"});
  EXPECT_EQ(few.status, 2);
  EXPECT_EQ(lines(few.err).size(), 1U) << few.err;
  EXPECT_THAT(few.err, HasSubstr("more latencies, or a larger tail_share"));
}

}  // namespace
}  // namespace hvp::cli::fit_links_test
