// Faults that the program asks for while the board runs: what they do is what the scenario's do.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/board/hvp_board.h"
#include "tests/app/board/faulty_program.h"
#include "tests/vp/child_output.h"

namespace hvp::test::injected_fault_test {
namespace {

constexpr std::array<std::int32_t, kUnknowns> kRhs = {640, 640, 640, 640, 640, 640};

// "fault[0].kind=late-dma", "fault[0].delay=3 ms" as "kind=late-dma,delay=3 ms".
std::string words_of(const FaultCase& fault) {
  std::string words;
  for (const std::string_view key : fault.keys) {
    words += words.empty() ? "" : ",";
    words += key.substr(std::string_view("fault[0].").size());
  }
  return words;
}

std::string inject(hvp_board* board, const std::string& words) {
  std::array<char, 256> why{};
  return hvp_board_inject(board, words.c_str(), why.data(), why.size()) ? "" : why.data();
}

// The records of some jobs, the driver's word and the time behind each. `before` is called before
// each job.
template <class Before>
std::string records(Program& program, const Before& before) {
  if (program.board == nullptr || program.open() != HVP_OK) return program.why.data();
  std::string text;
  for (int n = 0; n < kJobs; ++n) {
    before(n);
    std::array<std::int32_t, kUnknowns> u{};
    const hvp_status said =
        hvp_solve(&program.device, kRhs.data(), u.data(), u.size(), kLongestWait);
    if (said != HVP_OK && !program.recover()) return text + "no recovery";
    hvp_board_job job{};
    if (!hvp_board_last_job(program.board, &job)) return text + "no job";
    text += fmt::format("{} {} {} {} {} {} {} {}, {} at {}\n", job.number, job.begin_ps, job.end_ps,
                        job.host_ps, job.bus_ps, job.fpga_ps, hvp_status_name(job.status), u[0],
                        hvp_status_name(said), hvp_board_now_ps(program.board));
  }
  // A fault that did not happen is named.
  testing::internal::CaptureStderr();
  hvp_board_close(program.board);
  program.board = nullptr;
  return text + testing::internal::GetCapturedStderr();
}

Parameters without_fault(Parameters parameters) {
  const bool with_pci = parameters.fault.with_pci;
  parameters.fault = {};
  parameters.fault.with_pci = with_pci;
  return parameters;
}

std::string injected_records(const Parameters& parameters, int before_job,
                             const std::string& more) {
  return output_of_child([&](std::string& told) {
    Program program(without_fault(parameters));
    told = records(program, [&](int job) {
      if (job != before_job) return;
      const std::string why = inject(program.board, words_of(parameters.fault) + more);
      if (!why.empty()) program.why = {'?'};
    });
    if (program.why.front() == '?') told = "refused";
  });
}

std::vector<Parameters> faults() {
  std::vector<Parameters> all = all_parameters();
  std::erase_if(all, [](const Parameters& p) { return p.fault.keys.empty(); });
  return all;
}

class InjectedFault : public testing::TestWithParam<Parameters> {};

TEST_P(InjectedFault, IsTheScenarios) {
  const std::string of_scenario = output_of_child([&](std::string& told) {
    Program program(GetParam());
    told = records(program, [](int) {});
  });
  ASSERT_EQ(std::ranges::count(of_scenario, '\n'), kJobs) << of_scenario;
  EXPECT_EQ(injected_records(GetParam(), 0, fmt::format(",frame={}", kFaultyJob)), of_scenario);
  EXPECT_EQ(injected_records(GetParam(), kFaultyJob, fmt::format(",frame={}", kFaultyJob)),
            of_scenario);
  // The next is the next job's.
  EXPECT_EQ(injected_records(GetParam(), kFaultyJob, ""), of_scenario);
}

INSTANTIATE_TEST_SUITE_P(All, InjectedFault, testing::ValuesIn(faults()), name_of);

class Injection : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_NE(program.board, nullptr) << program.why.data();
    ASSERT_EQ(program.open(), HVP_OK);
  }
  hvp_status solve() {
    const std::uint64_t began = hvp_board_now_ps(program.board);
    const hvp_status status =
        hvp_solve(&program.device, kRhs.data(), u.data(), u.size(), kLongestWait);
    took = hvp_board_now_ps(program.board) - began;
    return status;
  }
  std::string inject(const std::string& words) {
    return injected_fault_test::inject(program.board, words);
  }
  // By the wait's time-out of 20 ms.
  bool is_late() const { return took > 20'000'000'000; }

  Program program{Parameters{.fault = {}, .dma = false, .notification = "intx", .pcie = false}};
  std::array<std::int32_t, kUnknowns> u{};
  std::uint64_t took = 0;  // ps
};

TEST_F(Injection, ANumberOfJobsFromOneOnAndNoMore) {
  EXPECT_EQ(inject("kind=lost-interrupt,frame=1,count=2"), "");
  std::vector<bool> late;
  for (int n = 0; n < 5; ++n) {
    EXPECT_EQ(solve(), HVP_OK);
    late.push_back(is_late());
  }
  EXPECT_EQ(late, (std::vector<bool>{false, true, true, false, false}));
  EXPECT_EQ(inject("kind=lost-interrupt,count=2"), "");
  late.clear();
  for (int n = 0; n < 4; ++n) {
    EXPECT_EQ(solve(), HVP_OK);
    late.push_back(is_late());
  }
  EXPECT_EQ(late, (std::vector<bool>{true, true, false, false}));
}

// The next interrupt is that of the job under way, the next start that of the next job.
TEST_F(Injection, TheNextIsTheNextAtTheFaultsPlace) {
  ASSERT_EQ(hvp_write_rhs(&program.device, kRhs.data(), kRhs.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&program.device), HVP_OK);
  EXPECT_EQ(inject("kind=lost-interrupt"), "");
  EXPECT_EQ(inject("kind=stuck-busy"), "");
  const std::uint64_t began = hvp_board_now_ps(program.board);
  EXPECT_EQ(hvp_wait(&program.device, kLongestWait), HVP_OK);
  EXPECT_GT(hvp_board_now_ps(program.board) - began, 1000 * kLongestWait);
  EXPECT_EQ(solve(), HVP_ERROR_TIMEOUT);
}

TEST_F(Injection, ABoardThatGoesAndComesBackTwice) {
  EXPECT_EQ(inject("kind=device-gone,frames=1,count=2"), "");
  EXPECT_EQ(solve(), HVP_ERROR_BUS);
  ASSERT_TRUE(program.recover());
  EXPECT_EQ(solve(), HVP_ERROR_BUS);
  ASSERT_TRUE(program.recover());
  EXPECT_EQ(solve(), HVP_OK);
}

TEST_F(Injection, AWrongWordChangesNothing) {
  const std::vector<std::pair<std::string, std::string>> refused = {
      {"kind=lost", "kind=lost: expected \"lost-interrupt\""},
      {"kund=lost-interrupt", "kund=lost-interrupt: "},
      {"", "an empty word: expected KEY=VALUE, such as kind=lost-interrupt"},
      {"kind=stuck-busy,", "an empty word: expected KEY=VALUE"},
      {"stuck-busy", "stuck-busy: expected KEY=VALUE"},
      {"kind=stuck-busy,kind=lost-interrupt", "kind: is there twice: expected it once"},
      {"kind=stuck-busy,frame=3,frame = 4", "frame: is there twice: expected it once"},
      {"kind=lost-interrupt,frame=1,rate=0.5", "frame"},
      {"kind=lost-interrupt,rate=0.5,count=2", "count=2: goes with frame"},
      {"kind=device-gone,count=2", "count=2: a board that is gone for good goes once"},
      {"kind=lost-interrupt,bits=2", "bits=2"},
      {"kind=late-dma,delay=3 ms", "late-dma needs a DMA engine"},
      {"kind=late-dma,delay=3 m", "delay=3 m: "},
      {"kind=corrupted-word,access=status", "only blocks are corrupted"}};
  for (const auto& [words, why] : refused) {
    const std::string said = inject(words);
    EXPECT_TRUE(said.starts_with("hvp_board_inject: ")) << said;
    EXPECT_NE(said.find(why), std::string::npos) << words << ": " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_FALSE(is_late());
  hvp_board_job job{};
  ASSERT_TRUE(hvp_board_last_job(program.board, &job));
  EXPECT_EQ(inject("kind=stuck-busy,frame=0"),
            "hvp_board_inject: frame=0: job 0 is over: expected 1 or later");
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_FALSE(hvp_board_inject(program.board, nullptr, nullptr, 0));
  testing::internal::CaptureStderr();
  hvp_board_close(program.board);
  program.board = nullptr;
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Injection, WhatDidNotHappenIsSaid) {
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(inject("kind=lost-interrupt,count=3"), "");
  EXPECT_EQ(inject("kind=stuck-busy,frame=9"), "");
  EXPECT_EQ(inject("kind=master-abort,access=acknowledge,frame=2,count=3"), "");
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(inject("kind=saturated-solve"), "");
  testing::internal::CaptureStderr();
  hvp_board_close(program.board);
  program.board = nullptr;
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "warning: [[fault]] lost-interrupt happened in 1 of 3 jobs\n"
            "warning: [[fault]] stuck-busy did not happen: it is asked for in frame 9, and there "
            "were 2\n"
            "warning: [[fault]] master-abort did not happen: it is asked for in frame 2, and there "
            "were 2\n"
            "warning: [[fault]] saturated-solve did not happen: it was asked for after 2 frames, "
            "and since then no solve was started that no other fault took\n");
}

}  // namespace
}  // namespace hvp::test::injected_fault_test
