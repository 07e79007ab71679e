// Probes with devices and hands of their own, as a user writes them.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

namespace hvp::cli::own_devices_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// A wall that a probe presses; the tables behind it.
std::string probe(const std::string& own = "") {
  return "[[probe]]\nstart = [\"0 mm\", \"0 mm\", \"2 mm\"]\n" + own +
         "[[probe.motion]]\nphase = \"press\"\nto = [\"0 mm\", \"0 mm\", \"-3 mm\"]\n"
         "duration = \"100 ms\"\n";
}

const std::string kShared =
    "[device]\nmodel = \"premium-1.5\"\nkinematics = false\n[hand]\nmodel = \"spring-damper\"\n";
const std::string kOmni = "[probe.device]\nmodel = \"omni\"\n";
const std::string kArm = "[probe.hand]\nmodel = \"arm\"\n";

class OwnDevices : public ::testing::Test {
 protected:
  Ended with(const std::string& command, const std::string& tables,
             std::vector<std::string> more = {}) {
    write(place_.path() / "s.toml",
          "title = \"own\"\nframes = 60\n[wall]\nstiffness = \"300 N/m\"\n[output]\npictures = "
          "false\n" +
              tables);
    more.insert(more.begin(), {command, "s.toml"});
    return hvp(place_.path(), more);
  }
  json run(const std::string& tables, const std::string& folder = "out") {
    const Ended ended = with("run", tables, {"--out", folder, "--set", "output.remedies=false"});
    EXPECT_LE(ended.status, 1) << ended.err;
    EXPECT_GE(ended.status, 0);
    return json::parse(read(place_.path() / folder / "summary.json"));
  }
  std::string header(const std::string& folder = "out") {
    return lines(read(place_.path() / folder / "frames.csv")).front();
  }
  void expect_refused(const std::string& tables, const std::string& line) {
    const Ended ended = with("run", tables, {"--out", "out"});
    EXPECT_EQ(ended.status, 2) << ended.out;
    EXPECT_EQ(lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(line));
  }

  ScratchDirectory place_;
};

// A copy of the shared tables is the shared device: what a probe does is the same to the byte.
TEST_F(OwnDevices, EqualToTheSharedTablesGiveTheSameFrames) {
  const std::string own =
      "[probe.device]\nmodel = \"premium-1.5\"\nkinematics = false\n"
      "[probe.hand]\nmodel = \"spring-damper\"\n";
  run(kShared + probe() + probe(), "shared");
  run(kShared + probe(own) + probe(own), "own");
  run(probe(own) + probe(own), "alone");
  const std::string frames = read(place_.path() / "shared/frames.csv");
  EXPECT_EQ(read(place_.path() / "own/frames.csv"), frames);
  EXPECT_EQ(read(place_.path() / "alone/frames.csv"), frames);
}

TEST_F(OwnDevices, TakeThePlaceOfTheSharedTableAsAWhole) {
  const std::string tables = kShared + probe() + probe(kOmni + kArm);
  const Ended once = with("resolve", tables);
  ASSERT_EQ(once.status, 0) << once.err;
  const std::string own = once.out.substr(once.out.find("[probe.device]"));
  EXPECT_THAT(own, HasSubstr("[probe.device.dynamics]\nat = \"tip\"\nmass = \"45 g\""));
  EXPECT_THAT(own, HasSubstr("[probe.device.friction]\nforce = \"260 mN\""));
  EXPECT_THAT(own, HasSubstr("[probe.hand]\nmodel = \"arm\""));
  EXPECT_THAT(own, HasSubstr("# [probe.device.motor] is not in this scenario"));
  EXPECT_THAT(own, Not(HasSubstr("daq")));
  write(place_.path() / "again.toml", once.out);
  EXPECT_EQ(hvp(place_.path(), {"resolve", "again.toml"}).out, once.out);

  const Ended changed = with("resolve", tables,
                             {"--set", "probe[1].device.encoder.resolution=1 mm", "--set",
                              "probe[1].device.friction=false"});
  EXPECT_THAT(changed.out,
              HasSubstr("[probe.device.encoder]\nat = \"tip\"\nresolution = \"1 mm\""));
  EXPECT_THAT(changed.out, HasSubstr("# [probe.device.friction] is not in this scenario"));
  const std::string shared = with("resolve", kShared + probe() + probe()).out;
  const Ended gone =
      with("resolve", tables, {"--set", "probe[1].device=false", "--set", "probe[1].hand=false"});
  EXPECT_EQ(gone.out.substr(gone.out.find("frames")), shared.substr(shared.find("frames")));
}

// Of two devices the one that is stable up to the softer wall counts.
TEST_F(OwnDevices, AreInTheResultsEachByItself) {
  const json two = run(kShared + probe() + probe(kOmni + kArm));
  ASSERT_EQ(two.at("loop").size(), 2U);
  EXPECT_NE(two.at("loop")[0].at("energy"), two.at("loop")[1].at("energy"));
  ASSERT_EQ(two.at("stiffnesses").size(), 2U);
  const json& first = two.at("stiffnesses")[0];
  const json& second = two.at("stiffnesses")[1];
  EXPECT_EQ(first.at("probe"), 0);
  EXPECT_EQ(second.at("probe"), 1);
  EXPECT_EQ(two.at("stiffness"), first.at("edge_N_m") <= second.at("edge_N_m") ? first : second);
  EXPECT_THAT(two.at("effects"), Contains("probe[1].device.friction"));
  const json alone =
      run(kOmni.substr(0, 1) + "device]\nmodel = \"omni\"\n[hand]\nmodel = \"arm\"\n" + probe() +
              probe(),
          "omnis");
  EXPECT_EQ(second.at("stable_N_m"), alone.at("stiffness").at("stable_N_m"));
  EXPECT_FALSE(alone.contains("stiffnesses"));
  EXPECT_FALSE(alone.at("stiffness").contains("probe"));
}

// The lines of frames.csv from a column on, without that column's name.
std::vector<std::string> from_column(const std::string& csv, const std::string& name) {
  std::vector<std::string> all = lines(csv);
  const std::string before = all.front().substr(0, all.front().find(name));
  const auto commas = std::count(before.begin(), before.end(), ',');
  all.erase(all.begin());
  for (std::string& line : all) {
    std::size_t from = 0;
    for (auto i = commas; i > 0; --i) from = line.find(',', from) + 1;
    line.erase(0, from);
  }
  return all;
}

// Probes before a wall do not touch each other, so that each moves, to the digit, as alone.
TEST_F(OwnDevices, MoveAsEachAlone) {
  const std::string ideal = "[fidelity]\nbus = \"untimed\"\nhost = \"untimed\"\n";
  run(ideal + kShared + probe("[probe.device]\n") + probe(kOmni + kArm), "together");
  run(ideal + probe(kOmni + kArm), "alone");
  const auto together = from_column(read(place_.path() / "together/frames.csv"), "probe1_tip_x_m");
  const auto alone = from_column(read(place_.path() / "alone/frames.csv"), "tip_x_m");
  ASSERT_EQ(alone.size(), 60U);
  EXPECT_EQ(together, alone);
  EXPECT_NE(alone.front(), alone.back());
}

TEST_F(OwnDevices, AnIdealOneIsBesideOneWithMass) {
  const json mixed = run(kShared + probe("[probe.device]\n") + probe());
  EXPECT_THAT(header(), Not(HasSubstr(",tip_x_m")));
  EXPECT_THAT(header(), HasSubstr(",probe1_tip_x_m"));
  EXPECT_EQ(mixed.at("loop")[0].at("energy").at("in_J").at("motors"), 0);
  EXPECT_EQ(mixed.at("stiffness").at("probe"), 1);
  const json other = run(probe() + probe(kOmni + kArm));
  EXPECT_THAT(header(), Not(HasSubstr(",tip_x_m")));
  EXPECT_EQ(other.at("stiffness").at("probe"), 1);
}

TEST_F(OwnDevices, AreUpToEight) {
  std::string tables = kShared;
  for (int i = 0; i < 4; ++i) tables += probe(kOmni) + probe("[probe.device]\n");
  const json eight = run(tables);
  EXPECT_EQ(eight.at("loop").size(), 8U);
  EXPECT_EQ(eight.at("stiffnesses").size(), 4U);
  EXPECT_THAT(header(), HasSubstr("probe6_tip_x_m"));
  EXPECT_THAT(header(), HasSubstr("probe7_contact_node"));
  expect_refused(tables + probe(), "probe: expected 1 to 8 probes, found 9");
}

TEST_F(OwnDevices, AreRefusedWithTheirLine) {
  expect_refused(kShared + probe() + probe("[probe.device]\nmodel = \"omny\"\n"),
                 "s.toml:21: probe[1].device.model: expected");
  expect_refused(kShared + probe() + probe("[probe.device]\nmodle = \"omni\"\n"),
                 "s.toml:21: probe[1].device.modle: unknown key; did you mean \"model\"");
  expect_refused(kShared + probe("[probe.device.daq]\nsampling_delay = \"1 us\"\n"),
                 "probe[0].device.daq: unknown key");
  expect_refused(kShared + probe() + probe("[probe.device.friction]\nforce = \"0.1 N\"\n"),
                 "probe[1].device.friction: only a device with mass can be moved by a force: "
                 "expected [device.dynamics] too");
  expect_refused(kShared + probe() + probe("[probe.device]\n" + kArm),
                 "probe[1].hand: a hand moves a device that has mass: expected "
                 "[probe[1].device.dynamics] too");
  expect_refused(kShared + probe() +
                     probe("[probe.device.dynamics]\n[probe.device.encoder]\nat = \"joints\"\n"),
                 "probe[1].device.encoder.at: \"joints\" needs a device that has some");
  expect_refused(kShared + probe("[probe.hand]\nmodel = \"arm\"\nmass = \"1 kg\"\n"),
                 "probe[0].hand.mass: belongs to model = \"custom\" only");
  expect_refused("[hand]\nmodel = \"arm\"\n" + probe(),
                 "hand: a hand moves a device that has mass: expected [device.dynamics] too");
}

}  // namespace
}  // namespace hvp::cli::own_devices_test
