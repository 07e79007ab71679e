#include <chrono>
#include <csignal>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <thread>

#include <gmock/gmock.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"

// Ctrl-C and TERM, sent where the program is known to be by what it has written.
namespace hvp::cli::interrupt_test {
namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

// A run that goes on until somebody ends it.
std::string endless_scene() {
  std::string text = kSmallScene;
  return text.replace(text.find("frames = 40"), 11, "frames = 100000000");
}

// False where the program ended before.
bool wait_until(Program& program, const std::function<bool()>& reached) {
  while (!reached()) {
    if (program.ended()) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

bool is_running(const fs::path& folder) {
  std::error_code none;
  const std::uintmax_t size = fs::file_size(folder / "frames.csv.part", none);
  return !none && size > 0;
}

void expect_whole_files_only(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    EXPECT_THAT(name, Not(EndsWith(".part")));
    EXPECT_NE(name, "engine.part.vcd");
  }
}

class Interrupt : public ::testing::TestWithParam<int> {};

TEST_P(Interrupt, LeavesWhatWasDone) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", endless_scene());
  const std::vector<std::string> arguments = {"run",
                                              "s.toml",
                                              "--out",
                                              "out",
                                              "--set",
                                              "output.trace_frames=3",
                                              "--set",
                                              "output.deformation_every_frames=20",
                                              "--trace-registers"};
  const fs::path out = place.path() / "out";
  Program program(place.path(), arguments);
  ASSERT_TRUE(wait_until(program, [&] { return is_running(out); })) << program.wait().err;
  program.signal(GetParam());
  const Ended ended = program.wait();
  EXPECT_EQ(ended.signal, GetParam()) << ended.err;
  expect_whole_files_only(place.path());

  std::smatch found;
  ASSERT_TRUE(
      std::regex_search(ended.err, found, std::regex("interrupted at frame ([0-9]+) of 100000000")))
      << ended.err;
  EXPECT_EQ(lines(ended.err).size(), 1U);
  const std::string frames = found[1];
  EXPECT_THAT(ended.out, HasSubstr("interrupted    at frame " + frames + " of 100000000"));
  EXPECT_THAT(ended.out, HasSubstr("held so far"));
  EXPECT_THAT(ended.out, Not(HasSubstr("PASS")));
  const auto summary = nlohmann::json::parse(read(out / "summary.json"));
  EXPECT_TRUE(summary.at("partial").get<bool>());
  EXPECT_EQ(summary.at("frames_asked"), 100000000);
  EXPECT_EQ(summary.at("deadline").at("frames"), std::stoll(frames));
  EXPECT_TRUE(nlohmann::json::accept(read(out / "trace.json")));
  EXPECT_TRUE(nlohmann::json::accept(read(out / "performance.json")));

  // The frames that were done are those of a run that ends there.
  std::vector<std::string> shorter = arguments;
  shorter[3] = "shorter";
  shorter.insert(shorter.end(), {"--set", "frames=" + frames});
  const Ended whole = hvp(place.path(), shorter);
  ASSERT_LE(whole.status, 1) << whole.err;
  auto rest = nlohmann::json::parse(read(place.path() / "shorter" / "summary.json"));
  EXPECT_FALSE(rest.at("partial").get<bool>());
  rest["partial"] = true;
  rest["frames_asked"] = 100000000;
  rest["title"] = summary.at("title");  // a what-if has its own
  rest["verdict"] = "held so far";
  EXPECT_EQ(rest, summary);
  EXPECT_EQ(names(out), names(place.path() / "shorter"));
  for (const std::string& name : names(out)) {
    if (name == "summary.json" || name == "performance.json" || name == "scenario.resolved.toml") {
      continue;
    }
    EXPECT_TRUE(read(out / name) == read(place.path() / "shorter" / name)) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(By, Interrupt, ::testing::Values(SIGINT, SIGTERM, SIGHUP));

// Both reach a program that is stopped at once when it goes on: the first is noted, the second ends
// it, before a frame's end.
TEST(InterruptTwice, EndsAtOnce) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", endless_scene());
  const fs::path out = place.path() / "out";
  Program program(place.path(), {"run", "s.toml", "--out", "out", "--trace-registers"});
  ASSERT_TRUE(wait_until(program, [&] { return is_running(out); })) << program.wait().err;
  program.signal(SIGSTOP);
  program.signal(SIGINT);
  program.signal(SIGTERM);
  program.signal(SIGCONT);
  const Ended ended = program.wait();
  EXPECT_TRUE(ended.signal == SIGINT || ended.signal == SIGTERM) << ended.status;
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(ended.err, "hvp: interrupted\n");
  expect_whole_files_only(place.path());
  EXPECT_THAT(names(out), Not(::testing::Contains("summary.json")));
  EXPECT_THAT(names(out), Not(::testing::Contains("frames.csv")));
}

// The mesher is a process of its own: it ends with the program.
TEST(InterruptMeshing, EndsTheMesherToo) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", kSmallScene);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"mesh", "sphere", "--nodes", "400000", "--out", "mesh.vtu"},
        {"export", "s.toml", "--set", "object.mesh.nodes=400000", "--out", "out"}}) {
    Program program(place.path(), arguments);
    std::vector<pid_t> children;
    ASSERT_TRUE(wait_until(program, [&] {
      children = program.children();
      return !children.empty();
    })) << program.wait().err;
    program.signal(SIGINT);
    const Ended ended = program.wait();
    EXPECT_EQ(ended.signal, SIGINT);
    EXPECT_EQ(ended.err, "hvp: interrupted\n");
    // Killed with its parent; whoever adopted it may not have reaped it yet.
    for (const pid_t child : children) {
      while (::kill(child, 0) == 0) {
        std::string state = read("/proc/" + std::to_string(child) + "/stat");
        if (state.find(") Z ") != std::string::npos) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
  }
  EXPECT_EQ(names(place.path()), std::vector<std::string>{"s.toml"});
}

// The engine's waveform is a file that SystemC's tracer writes.
TEST(InterruptEngine, KeepsTheWaveformSoFar) {
  const ScratchDirectory place;
  write(place.path() / "s.toml", endless_scene());
  for (const char* first : {"first_frame=0", "first_frame=99999999"}) {
    const fs::path out = place.path() / "out";
    Program program(place.path(), {"run", "s.toml", "--out", "out", "--set",
                                   "fidelity.accelerator=cycle-accurate", "--set",
                                   std::string("output.waveform.") + first});
    ASSERT_TRUE(wait_until(program, [&] { return is_running(out); })) << program.wait().err;
    program.signal(SIGINT);
    const Ended ended = program.wait();
    EXPECT_EQ(ended.signal, SIGINT) << ended.err;
    expect_whole_files_only(place.path());
    EXPECT_TRUE(fs::exists(out / "engine.vcd"));
    EXPECT_TRUE(fs::exists(out / "summary.json"));
  }
}

// As nohup and a shell's background jobs start it.
TEST(InterruptIgnored, StaysIgnored) {
  const ScratchDirectory place;
  std::string text = endless_scene();
  write(place.path() / "s.toml", text);
  const fs::path out = place.path() / "out";
  struct sigaction ignore {};
  struct sigaction before {};
  ignore.sa_handler = SIG_IGN;
  ASSERT_EQ(::sigaction(SIGHUP, &ignore, &before), 0);
  Program program(place.path(), {"run", "s.toml", "--out", "out"});
  ::sigaction(SIGHUP, &before, nullptr);
  ASSERT_TRUE(wait_until(program, [&] { return is_running(out); })) << program.wait().err;
  program.signal(SIGHUP);
  const std::uintmax_t size = fs::file_size(out / "frames.csv.part");
  ASSERT_TRUE(wait_until(program, [&] { return fs::file_size(out / "frames.csv.part") > size; }));
  program.signal(SIGTERM);
  EXPECT_EQ(program.wait().signal, SIGTERM);
}

}  // namespace
}  // namespace hvp::cli::interrupt_test
