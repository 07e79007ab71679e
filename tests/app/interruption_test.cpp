#include <csignal>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "app/results/part_files.h"
#include "app/results/pictures.h"
#include "tests/app/scratch_directory.h"

namespace hvp::results::interruption_test {
namespace {

class InterruptionTest : public ::testing::Test {
 protected:
  ScratchDirectory place_;
};

// A whole file takes the place of what has its name: not a device's, nor a pipe's.
TEST_F(InterruptionTest, WhatIsNoFileKeepsItsPlace) {
  const auto pipe = place_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(write_through_part_file(pipe, "words"), std::runtime_error);
  EXPECT_THROW(PartStream{pipe}, std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_FALSE(std::filesystem::exists(place_.path() / "pipe.part"));
}

using InterruptionDeathTest = InterruptionTest;

TEST_F(InterruptionDeathTest, TheFilesThatAreBeingWrittenGoAndTheOthersStay) {
  const auto whole = place_.path() / "whole";
  const auto half = place_.path() / "half";
  EXPECT_EXIT(
      {
        end_cleanly_when_interrupted();
        write_through_part_file(whole, "all of it");
        PartStream stream(half);
        stream.write(std::string(100'000, 'x'));
        if (!std::filesystem::exists(place_.path() / "half.part")) std::_Exit(1);
        ::raise(SIGTERM);
        std::_Exit(2);
      },
      ::testing::KilledBySignal(SIGTERM), "hvp: interrupted");
  EXPECT_TRUE(std::filesystem::exists(whole));
  EXPECT_FALSE(std::filesystem::exists(half));
  EXPECT_FALSE(std::filesystem::exists(place_.path() / "half.part"));
}

TEST_F(InterruptionDeathTest, TheFirstSignalIsNotedAndTheSecondEnds) {
  EXPECT_EXIT(
      {
        end_cleanly_when_interrupted();
        const DeferredInterruption deferred;
        if (interrupted() != 0) std::_Exit(1);
        ::raise(SIGINT);
        if (interrupted() != SIGINT) std::_Exit(2);
        ::raise(SIGTERM);
        std::_Exit(3);
      },
      ::testing::KilledBySignal(SIGTERM), "hvp: interrupted");
}

TEST_F(InterruptionDeathTest, TheProgramEndsAsTheNotedSignalWouldHaveEndedIt) {
  EXPECT_EXIT(
      {
        end_cleanly_when_interrupted();
        const DeferredInterruption deferred;
        ::raise(SIGINT);
        end_as_interrupted();
      },
      ::testing::KilledBySignal(SIGINT), "^$");
}

// The program that draws asks for the interruption itself, and would then draw for ever.
TEST_F(InterruptionDeathTest, DrawingIsGivenUp) {
  const auto script = place_.path() / "draw";
  std::ofstream(script) << "#!/bin/sh\nkill -TERM $PPID\nexec sleep 600\n";
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  const auto server = place_.path() / "Xvfb";
  std::ofstream(server) << "#!/bin/sh\necho 4321 >&3\nexec sleep 600\n";
  std::filesystem::permissions(server, std::filesystem::perms::owner_all);
  end_cleanly_when_interrupted();
  const DeferredInterruption deferred;
  const PictureOutcome outcome =
      draw_pictures(place_.path(), {.draw_program = script, .display = "", .xvfb = server});
  EXPECT_EQ(interrupted(), SIGTERM);
  EXPECT_FALSE(outcome.drawn);
  EXPECT_EQ(outcome.reason, "interrupted: deformation.png and latency.png were not drawn");
  // And is not begun again.
  EXPECT_EQ(
      draw_pictures(place_.path(), {.draw_program = script, .display = "", .xvfb = server}).reason,
      outcome.reason);
}

// A pipe of that name would be waited for, and a link written through.
TEST_F(InterruptionTest, APartFileIsAlwaysANewOne) {
  const auto file = place_.path() / "a.json";
  const auto elsewhere = place_.path() / "elsewhere";
  std::ofstream(elsewhere) << "kept";
  std::filesystem::create_symlink(elsewhere, part_of(file));
  write_through_part_file(file, "new");
  EXPECT_FALSE(std::filesystem::is_symlink(file));
  std::string text;
  std::ifstream(elsewhere) >> text;
  EXPECT_EQ(text, "kept");
}

}  // namespace
}  // namespace hvp::results::interruption_test
