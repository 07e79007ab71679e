// What hvp-draw says of results that are missing or damaged. It reads before it draws, so no
// display is needed.

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/results/launched_program.h"
#include "tests/app/sample_loop.h"
#include "tests/app/sample_run.h"
#include "tests/app/scratch_directory.h"

namespace hvp::results::draw_input_test {
namespace {

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), with);
}

class DrawInputTest : public testing::Test {
 protected:
  DrawInputTest() {
    sample::write_run(scratch_.path(), {.frames = 20, .step_every = 10, .cells = 2});
  }

  std::filesystem::path file(const char* name) const { return scratch_.path() / name; }

  // hvp-draw refuses with one line that holds `words`, and leaves no file of its own.
  void expect_refused(const std::string& words) {
    expect_refused({scratch_.path().string()}, words);
  }
  void expect_map_refused(const std::string& words) {
    expect_refused({"--stability-map", file("map.csv"), file("map.png")}, words);
  }
  void expect_refused(const std::vector<std::string>& arguments, const std::string& words) {
    LaunchedProgram::Options options;
    options.environment = {{"DISPLAY", ""}};
    LaunchedProgram child(HVP_DRAW_PROGRAM, arguments, options);
    const auto result = child.wait(std::chrono::seconds(60));
    EXPECT_EQ(result.exit_status, 2) << "signal " << result.signal << ", " << result.errors;
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
    EXPECT_NE(result.errors.find(words), std::string::npos) << result.errors;
    EXPECT_EQ(result.output, "");
    for (const auto& entry : std::filesystem::directory_iterator(scratch_.path())) {
      EXPECT_NE(entry.path().extension(), ".png");
      EXPECT_NE(entry.path().extension(), ".part");
    }
  }

  ScratchDirectory scratch_;
};

TEST_F(DrawInputTest, MissingFiles) {
  std::filesystem::remove(file("deformation_000010.vtu"));
  expect_refused("deformation_000010.vtu: no such file");
  std::filesystem::remove(file("summary.json"));
  expect_refused("summary.json: no such file");
  std::filesystem::remove(file("frames.csv"));
  expect_refused("frames.csv: no such file");
}

TEST_F(DrawInputTest, FramesThatAreNotATable) {
  const std::string good = bytes_of(file("frames.csv"));
  write(file("frames.csv"), "");
  expect_refused("frames.csv:1: has no column 'frame'");
  write(file("frames.csv"), good.substr(0, good.find('\n') + 1));
  expect_refused("frames.csv: has no frame");
  write(file("frames.csv"), replaced(good, "latency_us", "latency_ms"));
  expect_refused("frames.csv:1: has no column 'latency_us'");
  write(file("frames.csv"), replaced(good, "\n3,", "\nthree,"));
  expect_refused("frames.csv:5: frame is 'three', expected a number");
  write(file("frames.csv"), replaced(good, "\n3,", "\n3,1,"));
  expect_refused("frames.csv:5: 9 fields, the header has 8");
  write(file("frames.csv"), good.substr(0, good.size() - 25));
  expect_refused("frames.csv:21: ");
}

TEST_F(DrawInputTest, ClosedLoopWithoutItsColumnsOrNumbers) {
  sample::add_loop(scratch_.path(), {.probes = 2});
  const std::string good = bytes_of(file("frames.csv"));
  write(file("frames.csv"), replaced(good, ",port_J", ",port_mJ"));
  expect_refused("frames.csv:1: has no column 'port_J'");
  write(file("frames.csv"), replaced(good, "probe1_hand_y_N", "probe1_hand_N"));
  expect_refused("frames.csv:1: has no column 'probe1_hand_y_N'");
  write(file("frames.csv"), good.substr(0, good.size() - 2) + "x\n");
  expect_refused("frames.csv:21: probe1_fed_in is '");
  write(file("frames.csv"), replaced(good, "\n3,6000,", "\n3,-6000,"));
  expect_refused("frames.csv:5: born_us is '-6000', expected no less than in the line before");
}

TEST_F(DrawInputTest, MapThatIsNotOne) {
  expect_map_refused("map.csv: no such file");
  const std::string header =
      "damping_N_s_m,stiffness_max_N_m,stiffness_linear_N_m,stiffness_passive_N_m\n";
  const auto refused = [&](const std::string& bytes, const std::string& words) {
    write(file("map.csv"), bytes);
    expect_map_refused(words);
  };
  refused("", "map.csv:1: has no column 'damping_N_s_m'");
  refused("# title\n", "map.csv:2: has no column 'damping_N_s_m'");
  refused("damping_N_s_m,stiffness_max_N_m,stiffness_linear_N_m\n0,1,2\n",
          "map.csv:1: has no column 'stiffness_passive_N_m'");
  refused(header, "map.csv: has no row");
  refused("# title\n" + header + "0,1,2\n", "map.csv:3: 3 fields, the header has 4");
  refused(header + "0,1,,3\n", "map.csv:2: stiffness_linear_N_m is '', expected a number");
  refused(header + "0,inf,2,3\n",
          "map.csv:2: stiffness_max_N_m is 'inf', expected a finite number");
  refused(header + "1,1,2,3\n1,1,2,3\n",
          "map.csv:3: damping_N_s_m is '1', expected more than in the row before");
  std::string many = header;
  for (int i = 0; i <= 200; ++i) many += std::to_string(i) + ",1,2,3\n";
  refused(many, "map.csv:202: expected no more than 200 rows");
}

TEST_F(DrawInputTest, SummaryThatIsNotOne) {
  const std::string good = bytes_of(file("summary.json"));
  write(file("summary.json"), good.substr(0, good.size() / 2));
  expect_refused("summary.json: not well-formed JSON");
  write(file("summary.json"), "[]");
  expect_refused("summary.json has no 'deadline'");
  write(file("summary.json"), replaced(good, "\"period_us\": 2000.0", "\"period_us\": \"2 ms\""));
  expect_refused("deadline.period_us is \"2 ms\", expected microseconds");
  write(file("summary.json"), replaced(good, "\"phase\": \"solve\",", ""));
  expect_refused("attribution[8] has no 'phase'");
}

TEST_F(DrawInputTest, ListOfStepsThatIsNotOne) {
  const std::string good = bytes_of(file("deformation.pvd"));
  write(file("deformation.pvd"), good.substr(0, good.size() / 2));
  expect_refused("deformation.pvd: not well-formed XML");
  write(file("deformation.pvd"), "<VTKFile><Collection/></VTKFile>");
  expect_refused("deformation.pvd: lists no step");
  write(file("deformation.pvd"), "<VTKFile/>");
  expect_refused("deformation.pvd: has no <Collection>");
}

TEST_F(DrawInputTest, StepCutOffAnywhere) {
  const std::string good = bytes_of(file("deformation_000010.vtu"));
  for (int part = 0; part < 24; ++part) {
    write(file("deformation_000010.vtu"), good.substr(0, good.size() * std::size_t(part) / 24));
    expect_refused("deformation_000010.vtu: ");
  }
}

TEST_F(DrawInputTest, StepWithoutWhatThePictureNeeds) {
  const std::string good = bytes_of(file("deformation_000010.vtu"));
  for (const char* name : {"displacement", "anchor", "contact", "time_s", "frame",
                           "probe_position_m", "probe_radius_m", "contact_force_N"}) {
    const std::string quoted = "Name=\"" + std::string(name) + "\"";
    std::string other = quoted;
    other[6] = 'X';
    write(file("deformation_000010.vtu"), replaced(good, quoted, other));
    expect_refused("deformation_000010.vtu: has no array '" + std::string(name) + "'");
  }
  write(file("deformation_000010.vtu"), replaced(good, "UnstructuredGrid", "PolyData"));
  expect_refused("deformation_000010.vtu: not a VTK XML unstructured grid");
  // VTK's reader itself crashes on this.
  write(file("deformation_000010.vtu"), replaced(good, "\"Float64\"", "\"Float65\""));
  expect_refused("deformation_000010.vtu: holds an array of unknown type");
}

TEST_F(DrawInputTest, WrongNumberOfArguments) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{}, std::vector<std::string>{"a", "b"},
        std::vector<std::string>{"a", "b", "c"}}) {
    LaunchedProgram child(HVP_DRAW_PROGRAM, arguments, {});
    const auto result = child.wait(std::chrono::seconds(60));
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_EQ(
        result.errors,
        "usage: hvp-draw RUN_DIRECTORY | --stability-map IN.csv OUT.png | --fit IN.csv OUT.png "
        "X_LABEL Y_LABEL UNIT\n");
  }
}

}  // namespace
}  // namespace hvp::results::draw_input_test
