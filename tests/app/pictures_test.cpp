// How a run gets its pictures: which display is used, and what becomes of a drawing program that
// misbehaves. Shell scripts stand in for hvp-draw and for Xvfb.

#include "app/results/pictures.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/scratch_directory.h"

namespace hvp::results::pictures_test {
namespace {

constexpr const char* kLost = ": deformation.png and latency.png were not drawn";

// Sets an environment variable for the length of a test.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    set(value);
  }
  ~Variable() { set(old_ ? old_->c_str() : nullptr); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  void set(const char* value) {
    if (value != nullptr)
      setenv(name_, value, 1);
    else
      unsetenv(name_);
  }

 private:
  const char* name_;
  std::optional<std::string> old_;
};

class PicturesTest : public testing::Test {
 protected:
  std::filesystem::path script(const char* name, const std::string& body) {
    const auto path = scratch_.path() / name;
    std::ofstream(path) << "#!/bin/sh\n" << body << '\n';
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  }
  // An X server that says its number and serves nobody.
  std::filesystem::path idle_server() { return script("Xvfb", "echo 4321 >&3; exec sleep 600"); }
  PictureOutcome draw(const PictureTools& tools) { return draw_pictures(scratch_.path(), tools); }

  ScratchDirectory scratch_;
};

TEST_F(PicturesTest, WithoutDisplayAndXvfbSaysSo) {
  const auto outcome = draw({.draw_program = script("draw", "exit 0"), .display = "", .xvfb = {}});
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason, std::string("no display and Xvfb is not installed") + kLost);
  EXPECT_TRUE(outcome.files.empty());
}

TEST_F(PicturesTest, ADisplayThatDoesNotAnswerIsNone) {
  for (const char* display : {":64321", "unix:64321", "nowhere.invalid:0", "", "nonsense", ":"}) {
    EXPECT_FALSE(local_display_answers(display)) << display;
    const auto outcome =
        draw({.draw_program = script("draw", "exit 0"), .display = display, .xvfb = {}});
    EXPECT_EQ(outcome.reason, std::string("no display and Xvfb is not installed") + kLost);
  }
}

TEST_F(PicturesTest, ToolsOfThisProcessFollowTheEnvironment) {
  const auto bin = scratch_.path() / "bin";
  std::filesystem::create_directory(bin);
  std::filesystem::rename(idle_server(), bin / "Xvfb");
  Variable path("PATH", ("/nowhere:" + bin.string()).c_str());
  Variable display("DISPLAY", ":12");
  const PictureTools tools = PictureTools::of_this_process();
  EXPECT_EQ(tools.xvfb, bin / "Xvfb");
  EXPECT_EQ(tools.display, ":12");
  EXPECT_EQ(tools.draw_program.filename(), "hvp-draw");
  EXPECT_EQ(tools.draw_program.parent_path(),
            std::filesystem::read_symlink("/proc/self/exe").parent_path());
  path.set("/nowhere");
  display.set(nullptr);
  EXPECT_EQ(PictureTools::of_this_process().xvfb, "");
  EXPECT_EQ(PictureTools::of_this_process().display, "");
}

TEST_F(PicturesTest, TheServersDisplayAndTheDirectoryReachTheProgram) {
  const auto program = script("draw", "echo \"$DISPLAY\"; echo \"$1\"");
  const auto outcome = draw({.draw_program = program, .display = "", .xvfb = idle_server()});
  EXPECT_TRUE(outcome.drawn) << outcome.reason;
  EXPECT_EQ(outcome.reason, "");
  EXPECT_EQ(outcome.files, (std::vector<std::string>{":4321", scratch_.path().string()}));
}

TEST_F(PicturesTest, ACrashIsAReason) {
  const auto program = script("draw", "kill -ABRT $$");
  const auto outcome = draw({.draw_program = program, .display = "", .xvfb = idle_server()});
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason, std::string("hvp-draw crashed (Aborted)") + kLost);
}

TEST_F(PicturesTest, WarningsOfASuccessStayUnseenAndAFailureGivesItsFirstLine) {
  const auto server = idle_server();
  auto outcome = draw({.draw_program = script("draw", "echo warning >&2; echo latency.png"),
                       .display = "",
                       .xvfb = server});
  EXPECT_TRUE(outcome.drawn);
  EXPECT_EQ(outcome.files, std::vector<std::string>{"latency.png"});
  outcome = draw({.draw_program = script("draw", "echo first >&2; echo second >&2; exit 2"),
                  .display = "",
                  .xvfb = server});
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason, std::string("first") + kLost);
}

// A bound in wall time, far above what it takes and far below the program's own 600 s.
TEST_F(PicturesTest, AProgramThatHangsIsEnded) {
  const auto start = std::chrono::steady_clock::now();
  const auto outcome = draw({.draw_program = script("draw", "exec sleep 600"),
                             .display = "",
                             .xvfb = idle_server(),
                             .time_limit = std::chrono::milliseconds(200)});
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason, std::string("hvp-draw took longer than 0.2 s") + kLost);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

TEST_F(PicturesTest, AServerThatDoesNotStartIsAReason) {
  const auto program = script("draw", "exit 0");
  auto outcome = draw({.draw_program = program,
                       .display = "",
                       .xvfb = script("Xvfb", "echo 'no screens found' >&2; exit 1")});
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason, std::string("Xvfb did not start (no screens found)") + kLost);
  outcome = draw({.draw_program = program, .display = "", .xvfb = scratch_.path() / "gone"});
  EXPECT_FALSE(outcome.drawn);
}

TEST_F(PicturesTest, AProgramThatIsNotThereIsAReason) {
  const auto outcome =
      draw({.draw_program = scratch_.path() / "hvp-draw", .display = "", .xvfb = idle_server()});
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason, std::string("hvp-draw is not there") + kLost);
}

TEST_F(PicturesTest, PicturesOfAnEarlierRunGo) {
  for (const char* name : {"deformation.png", "latency.png", "loop.png", "mine.png"})
    std::ofstream(scratch_.path() / name) << "old";
  draw({.draw_program = script("draw", "exit 0"), .display = "", .xvfb = {}});
  EXPECT_FALSE(std::filesystem::exists(scratch_.path() / "deformation.png"));
  EXPECT_FALSE(std::filesystem::exists(scratch_.path() / "latency.png"));
  EXPECT_FALSE(std::filesystem::exists(scratch_.path() / "loop.png"));
  EXPECT_TRUE(std::filesystem::exists(scratch_.path() / "mine.png"));
}

TEST_F(PicturesTest, AMapIsDrawnInTheSameWay) {
  const auto png = scratch_.path() / "map.png";
  std::ofstream(png) << "old";
  const auto server = idle_server();
  auto outcome =
      draw_stability_map("in.csv", png,
                         {.draw_program = script("draw", "printf '%s\\n' \"$DISPLAY\" \"$@\""),
                          .display = "",
                          .xvfb = server});
  EXPECT_TRUE(outcome.drawn) << outcome.reason;
  EXPECT_EQ(outcome.files,
            (std::vector<std::string>{":4321", "--stability-map", "in.csv", png.string()}));
  EXPECT_FALSE(std::filesystem::exists(png)) << "the one before";
  outcome = draw_stability_map("in.csv", png,
                               {.draw_program = script("draw", "echo no such row >&2; exit 2"),
                                .display = "",
                                .xvfb = server});
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason, "no such row: map.png was not drawn");
}

}  // namespace
}  // namespace hvp::results::pictures_test
