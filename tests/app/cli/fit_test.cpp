#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "models/fit/twins.h"
#include "models/link/pcie.h"
#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// `hvp fit` as a user meets it, on logs that the platform and the models themselves make.
namespace hvp::cli::fit_test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

class FitCommand : public ::testing::Test {
 protected:
  // A device of 0.1 kg with 1 N s/m falls onto a wall, 0.3 ms late, and bounces.
  void bounce(const std::vector<std::string>& settings = {}) const {
    std::vector<std::string> arguments = {"run", scenario("wall.toml").string(), "--out", "bounce"};
    for (const std::string& setting :
         {std::string("wall.sides=one"), std::string("device.gravity=true"),
          std::string("wall.stiffness=300 N/m"), std::string("host.delay.time=0.3 ms"),
          std::string("probe.start=[\"0 mm\", \"0 mm\", \"30 mm\"]"),
          std::string("probe.motion[0].to=[\"0 mm\", \"0 mm\", \"30 mm\"]"),
          std::string("output.pictures=false")}) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    const Ended ended = hvp(place_.path(), arguments);
    ASSERT_EQ(ended.status, 0) << ended.err;
  }
  Ended fit(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "fit");
    return hvp(place_.path(), arguments);
  }
  Ended fit_device(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"bounce/frames.csv", "--model",         "device",
                                          "--column",          "time_us=born_us", "--column",
                                          "force_N=fz_N",      "--column",        "position_m=z_m"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return fit(arguments);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(place_.path() / name) << text;
  }
  void press(const std::string& name, double noise, std::int64_t seed) const {
    const fit::IndentationLog log =
        fit::press({}, {}, {170, 600, 0.62, 0.3, 0.18, 4, 0.4e-3, 0.01}, noise, seed);
    std::string text = "time_s,force_mN,travel_mm\n";
    for (std::size_t i = 0; i < log.time.size(); ++i) {
      text += std::to_string(log.time[i]) + "," + std::to_string(1e3 * log.force[i]) + "," +
              std::to_string(1e3 * log.travel[i]) + "\n";
    }
    write(name, text);
  }
  void expect_refused(const Ended& ended, const std::string& words) const {
    EXPECT_EQ(ended.status, 2) << ended.out;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(words));
  }
  static json parameter(const json& fitted, const std::string& name) {
    for (const json& p : fitted.at("parameters")) {
      if (p.at("name") == name) return p;
    }
    ADD_FAILURE() << "no parameter " << name;
    return {};
  }

  const ScratchDirectory place_;
};

TEST_F(FitCommand, FindsTheDeviceThatMadeTheLog) {
  bounce();
  const Ended ended = fit_device({"--json"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  const json fitted = json::parse(ended.out);
  EXPECT_EQ(fitted.at("model"), "device");
  EXPECT_NEAR(parameter(fitted, "mass").at("value"), 0.1, 1e-6);
  EXPECT_NEAR(parameter(fitted, "damping").at("value"), 1, 1e-5);
  EXPECT_NEAR(parameter(fitted, "coulomb").at("value"), 0, 1e-6);
  EXPECT_NEAR(parameter(fitted, "offset").at("value"), -0.980665, 1e-5);
  EXPECT_NEAR(parameter(fitted, "delay").at("value"), 0.3e-3, 1e-7);
  EXPECT_EQ(fitted.at("starts").at("reached"), fitted.at("starts").at("tried"));
  // Positions are read to a nanometre.
  EXPECT_LT(fitted.at("residual_rms"), 2e-9);
  EXPECT_LT(fitted.at("held_out_rms"), 2e-8);
  EXPECT_EQ(fitted.at("correlations").size(), 5U);
}

// The largest stable stiffness of what was fitted is that of the truth, as far as the intervals of
// the fit leave it open.
TEST_F(FitCommand, FittedDeviceHoldsTheWallThatTheTrueOneHolds) {
  bounce({"device.encoder.resolution=20 um", "device.friction.force=50 mN"});
  const Ended ended = fit_device({"--json", "--out", "fitted.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  const json damping = parameter(fitted, "damping");
  EXPECT_LE(damping.at("low"), 1.0);
  EXPECT_GE(damping.at("high"), 1.0);
  const json friction = parameter(fitted, "coulomb");
  EXPECT_LE(friction.at("low"), 0.05);
  EXPECT_GE(friction.at("high"), 0.05);

  write("wall.toml", "base = \"" + scenario("wall.toml").string() +
                         "\"\ninclude = \"fitted.toml\"\n[device]\nfriction = false\n");
  const auto stiffest = [&](const std::vector<std::string>& settings) {
    std::vector<std::string> arguments = {"stability", "wall.toml", "--json"};
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", setting});
    }
    const Ended found = hvp(place_.path(), arguments);
    EXPECT_EQ(found.status, 0) << found.err;
    return json::parse(found.out).at("stiffness_max").get<double>();
  };
  const auto with = [&](double b) {
    return stiffest({"device.dynamics.damping=" + std::to_string(b) + " N s/m"});
  };
  const double found = stiffest({});
  const double true_one =
      stiffest({"device.dynamics.damping=1 N s/m", "device.dynamics.mass=100 g"});
  EXPECT_NEAR(true_one, 1003, 5);
  EXPECT_NE(found, true_one);
  EXPECT_GE(true_one, 0.995 * with(damping.at("low")));
  EXPECT_LE(true_one, 1.005 * with(damping.at("high")));
  EXPECT_NEAR(found, true_one, 0.1 * true_one);
}

TEST_F(FitCommand, FindsTissueAndDrawsIt) {
  press("tissue.csv", 2e-3, 3);
  const Ended ended = fit({"tissue.csv", "--model", "qlv", "--json", "--starts", "3"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  EXPECT_NEAR(fitted.at("residual_rms"), 2e-3, 5e-4);
  const std::vector<std::pair<std::string, double>> truth = {
      {"q", 600}, {"g1", 0.62}, {"tau1", 0.3}, {"tau2", 4}};
  for (const auto& [name, value] : truth) {
    const json p = parameter(fitted, name);
    EXPECT_TRUE(p.at("identifiable")) << name;
    EXPECT_LE(p.at("low").get<double>(), value + 0.1 * value) << name;
    EXPECT_GE(p.at("high").get<double>(), value - 0.1 * value) << name;
  }
  const Ended text = fit({"tissue.csv", "--model", "qlv", "--starts", "1", "--fix", "offset=0.01"});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("fixed"));
  EXPECT_THAT(text.out, HasSubstr("left over"));
}

// What the fit writes of a specimen is a body that a run takes as it stands.
TEST_F(FitCommand, MakesATissueThatRuns) {
  press("tissue.csv", 2e-3, 3);
  const Ended ended =
      fit({"tissue.csv", "--model", "qlv", "--starts", "3", "--set", "specimen.area=7.85e-5",
           "--set", "specimen.height=10mm", "--out", "meat.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("the material's forces as a column are"));
  const std::string table = read(place_.path() / "meat.toml");
  for (const char* words : {"[object.material]", "young_modulus", "[object.model]",
                            "kind = \"fung\"", "exponent", "prony = [{ share = "}) {
    EXPECT_THAT(table, HasSubstr(words));
  }
  const Ended run =
      hvp(place_.path(), {"run", scenario("thesis-nonlinear.toml").string(), "--include",
                          "meat.toml", "--set", "frames=260", "--set", "output.pictures=false",
                          "--set", "output.remedies=false", "--out", "out"});
  EXPECT_LT(run.status, 2) << run.err;
  EXPECT_THAT(run.out, HasSubstr("dynamic, fung"));
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--set", "specimen.area=7.85e-5"}), "height");
}

// The platform's own body, pressed by its own probe and solved exactly: what it is made of comes
// back, up to the node's few hundredths of a millimetre sideways that the model leaves out and
// says.
TEST_F(FitCommand, FindsWhatARunsBodyIsMadeOf) {
  write("press.toml", "base = \"" + scenario("thesis-static.toml").string() + R"("
frames = 250
reference = false
[object.mesh]
nodes = 159
[object.material]
young_modulus = "7 kPa"
[host]
solver = "cholesky"
[probe]
start = ["0 mm", "0 mm", "55 mm"]
[[probe.motion]]
phase = "press"
to = ["0 mm", "0 mm", "42 mm"]
duration = "0.3 s"
[[probe.motion]]
phase = "press"
to = ["0 mm", "0 mm", "45 mm"]
duration = "0.1 s"
)");
  ASSERT_EQ(
      hvp(place_.path(), {"run", "press.toml", "--out", "press", "--set", "output.pictures=false"})
          .status,
      0);
  const Ended ended = fit({"press/frames.csv", "--model", "tissue", "--scenario", "press.toml",
                           "--set", "frames=true", "--fix", "poisson_ratio=0.45", "--starts", "2",
                           "--json", "--out", "fitted.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  EXPECT_NEAR(parameter(fitted, "young_modulus").at("value"), 7000, 0.004 * 7000);
  EXPECT_THAT(fitted.at("warnings").dump(), HasSubstr("aside of its way"));
  write("again.toml", "base = \"press.toml\"\ninclude = \"fitted.toml\"\n");
  const Ended explained = hvp(place_.path(), {"explain", "again.toml"});
  EXPECT_EQ(explained.status, 0) << explained.err;
}

// The same of a body that a proxy pressed, at rest or with inertia, and slid over: how the force
// comes about is known to the last digit.
TEST_F(FitCommand, FindsWhatABodyUnderAProxyIsMadeOf) {
  const auto written = [&](const std::string& base) {
    return "base = \"" + scenario(base).string() + R"("
frames = 300
reference = false
[contact]
kind = "proxy"
[object.mesh]
nodes = 159
[object.material]
young_modulus = "7 kPa"
[host]
solver = "cholesky"
[probe]
start = ["2 mm", "1 mm", "52 mm"]
[[probe.motion]]
phase = "press"
to = ["2 mm", "1 mm", "45 mm"]
duration = "0.2 s"
[[probe.motion]]
phase = "slide"
to = ["9 mm", "1 mm", "45 mm"]
duration = "0.3 s"
)";
  };
  write("static.toml", written("thesis-static.toml"));
  write("dynamic.toml", written("thesis.toml"));
  for (const std::string name : {"static", "dynamic"}) {
    ASSERT_LT(hvp(place_.path(), {"run", name + ".toml", "--out", name, "--set",
                                  "output.pictures=false", "--set", "output.remedies=false"})
                  .status,
              2);
    std::vector<std::string> arguments = {name + "/frames.csv",
                                          "--model",
                                          "tissue",
                                          "--scenario",
                                          name + ".toml",
                                          "--set",
                                          "frames=true",
                                          "--starts",
                                          "2",
                                          "--json",
                                          "--fix",
                                          "poisson_ratio=0.45"};
    const Ended ended = fit(arguments);
    ASSERT_EQ(ended.status, 0) << ended.err;
    const json fitted = json::parse(ended.out);
    EXPECT_NEAR(parameter(fitted, "young_modulus").at("value"), 7000, 1e-3 * 7000) << name;
    EXPECT_LT(fitted.at("residual_rms"), 1e-6);
    const auto refused = [&](const std::string& table, const std::string& words) {
      write("other.toml", "base = \"" + name + ".toml\"\n" + table);
      arguments[4] = "other.toml";
      expect_refused(fit(arguments), words);
    };
    refused("[contact]\nkind = \"node\"\n",
            "the contact is a proxy, and that of --scenario is a node");
    refused("[contact]\nkind = \"patch\"\n", "expected another contact.kind than \"patch\"");
    refused("[loads.gravity]\n", "found loads on the body");
  }
}

TEST_F(FitCommand, FindsAHand) {
  // m x" = F - b x' - k x for a hand of 1.5 kg on 375 N/m with 4.5 N s/m, in its two closed forms.
  std::string text = "time_ms,force_N,position_mm,intended_mm\n";
  const double pi = std::acos(-1.0);
  for (int i = 0; i < 4000; ++i) {
    const double t = 1e-3 * i;
    double force = 0;
    double x = 0;
    for (const double f : {1.1, 2.3, 3.9, 6.7}) {
      const double w = 2 * pi * f;
      const double stiff = 375 - 1.5 * w * w;
      const double viscous = 4.5 * w;
      force += std::sin(w * t);
      x += (stiff * std::sin(w * t) - viscous * std::cos(w * t)) /
           (stiff * stiff + viscous * viscous);
    }
    text +=
        std::to_string(i) + "," + std::to_string(force) + "," + std::to_string(1e3 * x) + ",0\n";
  }
  write("hand.csv", text);
  const Ended ended =
      fit({"hand.csv", "--model", "hand", "--json", "--starts", "2", "--out", "hand.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  EXPECT_NEAR(parameter(fitted, "mass").at("value"), 1.5, 1e-3);
  EXPECT_NEAR(parameter(fitted, "stiffness").at("value"), 375, 0.1);
  EXPECT_NEAR(parameter(fitted, "damping").at("value"), 4.5, 1e-2);
  const Ended explained = hvp(
      place_.path(), {"explain", scenario("wall-in-hand.toml").string(), "--include", "hand.toml"});
  EXPECT_EQ(explained.status, 0) << explained.err;
}

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

// Two specimens of one kind and a third that is a quarter stiffer: what lies between them is in the
// interval, which each log's own leaves out, and the noise of one is not blamed for it.
TEST_F(FitCommand, IntervalsOfSeveralLogsHoldWhatLiesBetweenThem) {
  std::vector<double> stiffness = {100, 102, 97};
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    bounce({fmt::format("device.dynamics.mass={} g", stiffness[i])});
    std::filesystem::copy_file(place_.path() / "bounce/frames.csv",
                               place_.path() / fmt::format("{}.csv", i),
                               std::filesystem::copy_options::overwrite_existing);
  }
  const auto fitted = [&](std::vector<std::string> logs, std::vector<std::string> more) {
    logs.insert(logs.end(), {"--model", "device", "--column", "time_us=born_us", "--column",
                             "force_N=fz_N", "--column", "position_m=z_m"});
    logs.insert(logs.end(), more.begin(), more.end());
    return fit(logs);
  };
  const json one = json::parse(fitted({"0.csv"}, {"--json"}).out);
  EXPECT_TRUE(one.at("logs").empty());
  EXPECT_FALSE(parameter(one, "mass").contains("between"));
  EXPECT_THAT(one.at("warnings").back().get<std::string>(), HasSubstr("of this log alone"));
  EXPECT_LT(parameter(one, "mass").at("high").get<double>(), 0.102);

  const Ended ended = fitted({"0.csv", "1.csv", "2.csv"}, {"--json", "--out", "all.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json all = json::parse(ended.out);
  const json mass = parameter(all, "mass");
  for (const double truth : {0.100, 0.102, 0.097}) {
    EXPECT_LT(mass.at("low"), truth);
    EXPECT_GT(mass.at("high"), truth);
  }
  // The sample's own standard deviation, since noise is a hundredth of it.
  EXPECT_NEAR(mass.at("between").at("deviation"), 2.5e-3, 2e-4);
  EXPECT_LT(mass.at("between").at("probability"), 1e-6);
  EXPECT_LT(mass.at("between").at("next_low"), mass.at("low"));
  EXPECT_THAT(all.at("warnings").front().get<std::string>(),
              HasSubstr("the logs disagree on mass"));
  ASSERT_EQ(all.at("logs").size(), 3U);
  EXPECT_NEAR(all.at("logs").at(2).at("values").at(0), 0.097, 2e-4);
  EXPECT_EQ(all.at("samples"), 3 * one.at("samples").get<int>());
  const std::string table = read(place_.path() / "all.toml");
  EXPECT_THAT(table, HasSubstr("mass = \"0.0996"));
  EXPECT_EQ(hvp(place_.path(), {"run", scenario("wall.toml").string(), "--include", "all.toml",
                                "--out", "with", "--set", "output.pictures=false"})
                .status,
            0);
  // In their order, and not of one that is twice there.
  EXPECT_THAT(fitted({"2.csv", "0.csv", "1.csv"}, {}).out, HasSubstr("2.csv, 0.csv, 1.csv"));
  expect_refused(fitted({"0.csv", "./0.csv"}, {}), "./0.csv: the log is given twice");
  expect_refused(fit({"0.csv", "1.csv", "--model", "host"}), "--model host: expected one log");
  expect_refused(fitted({"0.csv", "missing.csv"}, {}), "missing.csv");
}

// A device whose friction grows by half in the middle of the log: no interval of one model holds
// it, and the note says where it is from. One that stays as it is has no such note.
TEST_F(FitCommand, QuartersOfALogThatDisagreeWidenItsIntervals) {
  const auto log = [&](const std::string& name, double later) {
    double x = 0;
    double v = 0;
    std::string text = "time_s,force_N,position_m\n";
    constexpr int kSamples = 8000;
    for (int i = 0; i < kSamples; ++i) {
      const double t = 1e-3 * i;
      const double force = 0.8 * std::sin(9 * t) + 0.5 * std::sin(31 * t);
      text += fmt::format("{:.6f},{:.9f},{:.7f}\n", t, force, x);
      const double damping = i < kSamples / 2 ? 2.0 : later;
      for (int step = 0; step < 10; ++step) {
        v += 1e-4 * (force - damping * v) / 0.1;
        x += 1e-4 * v;
      }
    }
    write(name, text);
  };
  log("steady.csv", 2.0);
  log("changed.csv", 3.0);
  const std::vector<std::string> more = {"--model", "device", "--json", "--fix", "coulomb=0"};
  const auto fitted = [&](std::string name) {
    std::vector<std::string> arguments = {std::move(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json::parse(fit(arguments).out);
  };
  const json changed = fitted("changed.csv");
  EXPECT_THAT(changed.at("warnings").front().get<std::string>(),
              HasSubstr("the quarters of this log disagree on"));
  EXPECT_LT(parameter(changed, "damping").at("low"), 2.0);
  EXPECT_GT(parameter(changed, "damping").at("high"), 3.0);
  EXPECT_LT(parameter(changed, "damping").at("between").at("probability"), 0.01);
  const json steady = fitted("steady.csv");
  EXPECT_THAT(steady.at("warnings").dump(), Not(HasSubstr("disagree on damping")));
  EXPECT_NEAR(parameter(steady, "damping").at("value"), 2.0, 0.02);
  EXPECT_LT(parameter(steady, "damping").at("high"), 2.1);
}

// What one specimen's log alone tells has that log's interval, and the others' say nothing of it.
TEST_F(FitCommand, WhatOneLogAloneGivesIsSaidToBeIts) {
  press("a.csv", 1e-3, 1);
  press("b.csv", 1e-3, 2);
  const json same =
      json::parse(fit({"a.csv", "b.csv", "--model", "qlv", "--json", "--plot", "p.png"}).out);
  EXPECT_GT(parameter(same, "q").at("between").at("probability").get<double>(), 0.01);
  EXPECT_LT(parameter(same, "q").at("low"), 600);
  EXPECT_GT(parameter(same, "q").at("high"), 600);
  EXPECT_GT(parameter(same, "q").at("low").get<double>(), 0);
  EXPECT_THAT(same.at("warnings").dump(), HasSubstr("two logs tell little"));
  const json given = json::parse(
      fit({"a.csv", "b.csv", "--model", "qlv", "--json", "--fix", "contact=0.0004"}).out);
  EXPECT_TRUE(parameter(given, "contact").at("fixed"));
  EXPECT_FALSE(parameter(given, "contact").contains("between"));
}

TEST_F(FitCommand, AnswersAreTheSameBytesAgain) {
  press("tissue.csv", 2e-3, 3);
  const std::vector<std::string> arguments = {"tissue.csv", "--model", "qlv", "--json"};
  EXPECT_EQ(fit(arguments).out, fit(arguments).out);
}

TEST_F(FitCommand, APictureLeavesTheLogAsItIs) {
  press("tissue.csv", 2e-3, 3);
  const std::string before = read(place_.path() / "tissue.csv");
  const Ended ended =
      fit({"tissue.csv", "--model", "qlv", "--starts", "1", "--plot", "tissue.png"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(read(place_.path() / "tissue.csv"), before);
  EXPECT_TRUE(std::filesystem::exists(place_.path() / "tissue.fit.csv"));
}

// A motion that never reverses has friction and offset in one number.
TEST_F(FitCommand, OneWayMotionGivesNeitherFrictionNorOffset) {
  const fit::DeviceTwin twin;
  std::vector<double> command = fit::busy_command(3000, twin.period, 0.4);
  for (double& c : command) c = 0.6 + c;
  const fit::DeviceLog log = twin.follow(command);
  std::string text = "time_ms,force_N,position_mm\n";
  for (std::size_t i = 0; i < command.size(); ++i) {
    text += fmt::format("{},{},{}\n", i, command[i], 1e3 * log.position[i]);
  }
  write("one-way.csv", text);
  const Ended ended =
      fit({"one-way.csv", "--model", "device", "--json", "--starts", "2", "--out", "fitted.toml"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const json fitted = json::parse(ended.out);
  EXPECT_FALSE(parameter(fitted, "coulomb").at("identifiable"));
  EXPECT_FALSE(parameter(fitted, "offset").at("identifiable"));
  EXPECT_TRUE(parameter(fitted, "mass").at("identifiable"));
  EXPECT_THAT(parameter(fitted, "coulomb").at("remedy").get<std::string>(), HasSubstr("reverses"));
  EXPECT_THAT(read(place_.path() / "fitted.toml"), Not(HasSubstr("\nforce =")));
}

TEST_F(FitCommand, AnInterruptionLeavesTheBestSoFar) {
  press("tissue.csv", 2e-3, 3);
  // A machine under load may not have begun by then: a signal then ends it without a word.
  Ended ended;
  for (const int delay_ms : {500, 1000, 2000, 4000}) {
    Program program(place_.path(), {"fit", "tissue.csv", "--model", "qlv", "--starts", "1000",
                                    "--seed", std::to_string(delay_ms), "--out", "fitted.toml"});
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    program.signal(SIGINT);
    ended = program.wait();
    if (!ended.out.empty()) break;
  }
  EXPECT_EQ(ended.signal, SIGINT);
  EXPECT_THAT(ended.out, HasSubstr("stopped before the end"));
  EXPECT_THAT(read(place_.path() / "fitted.toml"), HasSubstr("stopped before the end"));
}

TEST_F(FitCommand, WrongInputEndsInOneLine) {
  press("tissue.csv", 2e-3, 3);
  expect_refused(fit({"nothing.csv", "--model", "qlv"}), "nothing.csv");
  expect_refused(fit({"tissue.csv", "--model", "glue"}), "device");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "stiffness=3"}), "tau1");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "c"}), "NAME=NUMBER");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "g1=2"}), "g1");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--fix", "c=1", "--fix", "c=2"}), "twice");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--set", "elastic=glue"}), "fung");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--out", "fitted.txt"}), ".toml");
  expect_refused(fit({"tissue.csv", "--model", "qlv", "--plot", "none/fit.png"}), "no folder");
  expect_refused(fit({"tissue.csv", "--model", "device"}), "");
  expect_refused(fit({"tissue.csv", "--model", "tissue"}), "--scenario");
  write("short.csv", "time_s,force_N,travel_mm\n0,0,0\n1,1,1\n");
  expect_refused(fit({"short.csv", "--model", "qlv"}), "short.csv");
  EXPECT_FALSE(std::filesystem::exists(place_.path() / "fitted.txt"));
}

}  // namespace
}  // namespace hvp::cli::fit_test
