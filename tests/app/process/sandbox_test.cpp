#include "app/process/sandbox.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "models/config/input_error.h"
#include "tests/mesh/surfaces.h"

namespace hvp::app::sandbox_test {
namespace {

using mesh::testing::refusal;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Work = std::function<std::string(const Progress&)>;

std::string run(const Work& work, const SandboxLimits& limits = {}) {
  return run_in_sandbox("the reader", "surface", limits, {}, work);
}
std::string reason(const Work& work, const SandboxLimits& limits = {}) {
  return refusal("surface", [&] { run(work, limits); });
}

TEST(Sandbox, ReturnsWhatTheWorkReturns) {
  const std::string large(5'000'000, '\0');  // more than a pipe holds
  EXPECT_EQ(run([&](const Progress&) { return large + "end"; }), large + "end");
  EXPECT_EQ(run([](const Progress&) { return ""; }), "");
}

TEST(Sandbox, PassesProgressOn) {
  std::vector<std::string> lines;
  run_in_sandbox(
      "the reader", "surface", {}, [&](std::string_view line) { lines.emplace_back(line); },
      [](const Progress& progress) {
        progress("one");
        progress("two");
        return "";
      });
  EXPECT_THAT(lines, ElementsAre("one", "two"));
}

TEST(Sandbox, PassesARefusalOnWithItsKey) {
  EXPECT_EQ(
      refusal("nodes",
              [] {
                run([](const Progress&) -> std::string { throw InputError("nodes", "too few"); });
              }),
      "too few");
}

TEST(Sandbox, TurnsACrashIntoARefusal) {
  EXPECT_THAT(reason([](const Progress&) -> std::string {
                std::signal(SIGSEGV, SIG_DFL);
                std::raise(SIGSEGV);
                return "";
              }),
              HasSubstr("the reader crashed (signal 11"));
  EXPECT_THAT(reason([](const Progress&) -> std::string { std::abort(); }), HasSubstr("crashed"));
}

TEST(Sandbox, TurnsExitIntoARefusal) {
  EXPECT_THAT(reason([](const Progress&) -> std::string { ::_exit(7); }),
              HasSubstr("ended without a result (exit status 7)"));
}

TEST(Sandbox, TurnsForeignExceptionsIntoARefusal) {
  EXPECT_THAT(reason([](const Progress&) -> std::string { throw std::runtime_error("odd"); }),
              HasSubstr("the reader failed: odd"));
  EXPECT_THAT(reason([](const Progress&) -> std::string { throw 3; }),
              HasSubstr("not an exception"));
  EXPECT_THAT(reason([](const Progress&) -> std::string { throw std::bad_alloc(); }),
              HasSubstr("ran out of memory"));
}

TEST(Sandbox, EndsAnEndlessLoop) {
  EXPECT_THAT(reason(
                  [](const Progress&) -> std::string {
                    volatile unsigned long count = 0;
                    while (true) count = count + 1;
                  },
                  {.cpu_seconds = 1}),
              HasSubstr("did not end within 1 s of CPU time"));
}

TEST(Sandbox, EndsAChildThatSleeps) {
  EXPECT_THAT(reason(
                  [](const Progress&) -> std::string {
                    while (true) ::pause();
                  },
                  {.cpu_seconds = 1}),
              HasSubstr("gave no answer within 4 s"));
}

TEST(Sandbox, WhatItPrintsIsDropped) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  run([](const Progress&) {
    std::puts("noise");
    std::fputs("noise", stderr);
    std::fflush(nullptr);
    return "";
  });
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace hvp::app::sandbox_test
