// The record of a job beside the caller's own clock and what the driver said: every fault, way of
// the data, notification and bus. Each board is a process of its own, as SystemC elaborates once.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/board/hvp_board.h"
#include "tests/app/board/faulty_program.h"

namespace hvp::test {
namespace {

class JobRecord : public testing::TestWithParam<Parameters> {};

TEST_P(JobRecord, IsTheCallersClockAndTheDriversWord) {
  Program program(GetParam());
  ASSERT_NE(program.board, nullptr) << program.why.data();
  ASSERT_EQ(program.open(), HVP_OK);
  const std::array<std::int32_t, kUnknowns> b = {640, 640, 640, 640, 640, 640};
  std::array<std::int32_t, kUnknowns> u{};
  for (int n = 0; n < kJobs; ++n) {
    const std::uint64_t began = hvp_board_now_ps(program.board);
    const hvp_status said = hvp_solve(&program.device, b.data(), u.data(), u.size(), kLongestWait);
    const std::uint64_t ended = hvp_board_now_ps(program.board);
    // Whatever the host does then, with or without the board, belongs to no job.
    if (said != HVP_OK) {
      ASSERT_TRUE(program.recover());
    }
    hvp_board_run_until_ps(program.board, hvp_board_now_ps(program.board) + 7'000'000);
    hvp_board_job job{};
    ASSERT_TRUE(hvp_board_last_job(program.board, &job));
    EXPECT_EQ(job.number, static_cast<std::uint64_t>(n));
    EXPECT_EQ(job.begin_ps, began) << "job " << n;
    EXPECT_EQ(job.end_ps, ended) << "job " << n << ": " << hvp_status_name(said);
    EXPECT_EQ(job.host_ps + job.bus_ps + job.fpga_ps, ended - began) << "job " << n;
    EXPECT_EQ(hvp_status_name(job.status), std::string(hvp_status_name(said))) << "job " << n;
    if (n != kFaultyJob) {
      EXPECT_EQ(said, HVP_OK);
    }
  }
}

// A host that stands still at random, at its accesses and before its interrupts.
struct Stalled {
  Parameters of;
  std::string seed;
};

std::vector<Stalled> all_stalled() {
  std::vector<Stalled> all;
  for (const Parameters& one : all_parameters()) {
    if (!one.fault.keys.empty()) continue;
    for (int seed = 1; seed <= 6; ++seed) all.push_back({one, std::to_string(seed)});
  }
  return all;
}

void PrintTo(const Stalled& stalled, std::ostream* out) {  // NOLINT(readability-identifier-naming)
  *out << "seed " << stalled.seed;
}

class StalledHost : public testing::TestWithParam<Stalled> {};

TEST_P(StalledHost, ItsRecordIsTheCallersClock) {
  const std::string seed = "seed=" + GetParam().seed;
  Program program(GetParam().of, {"guest.schedule=random", seed.c_str()});
  ASSERT_NE(program.board, nullptr) << program.why.data();
  ASSERT_EQ(program.open(), HVP_OK);
  const std::array<std::int32_t, kUnknowns> b = {640, 640, 640, 640, 640, 640};
  std::array<std::int32_t, kUnknowns> u{};
  for (int n = 0; n < 12; ++n) {
    const std::uint64_t began = hvp_board_now_ps(program.board);
    ASSERT_EQ(hvp_solve(&program.device, b.data(), u.data(), u.size(), kLongestWait), HVP_OK);
    const std::uint64_t ended = hvp_board_now_ps(program.board);
    hvp_board_job job{};
    ASSERT_TRUE(hvp_board_last_job(program.board, &job)) << "job " << n;
    EXPECT_EQ(job.number, static_cast<std::uint64_t>(n));
    EXPECT_EQ(job.begin_ps, began) << "job " << n;
    EXPECT_EQ(job.end_ps, ended) << "job " << n;
    EXPECT_EQ(job.host_ps + job.bus_ps + job.fpga_ps, ended - began) << "job " << n;
    EXPECT_EQ(job.status, HVP_OK) << "job " << n;
  }
}

INSTANTIATE_TEST_SUITE_P(All, StalledHost, testing::ValuesIn(all_stalled()),
                         [](const testing::TestParamInfo<Stalled>& test) {
                           return name_of({test.param.of, test.index}) + "_seed" + test.param.seed;
                         });

std::vector<Parameters> all_removals() {
  const FaultCase first = {.name = "first", .keys = {"fault[0].kind=surprise-removal"}};
  const FaultCase acknowledge = {
      .name = "acknowledge",
      .keys = {"fault[0].kind=surprise-removal", "fault[0].access=acknowledge"}};
  std::vector<Parameters> all;
  for (const bool pcie : {false, true}) {
    for (const char* const notification : {"intx", "msi", "polling"}) {
      for (const bool dma : {false, true}) all.push_back({first, dma, notification, pcie});
    }
    // By DMA the job is over then, with U and its record in the host's memory.
    all.push_back({acknowledge, false, "intx", pcie});
  }
  return all;
}

class Removal : public testing::TestWithParam<Parameters> {};

// From there on nothing answers, nothing interrupts, and no set-up goes well; the job's verdict is
// the driver's word.
TEST_P(Removal, IsForGood) {
  Program program(GetParam());
  ASSERT_NE(program.board, nullptr) << program.why.data();
  ASSERT_EQ(program.open(), HVP_OK);
  const std::array<std::int32_t, kUnknowns> b = {640, 640, 640, 640, 640, 640};
  std::array<std::int32_t, kUnknowns> u{};
  for (int n = 0; n < kFaultyJob; ++n) {
    ASSERT_EQ(hvp_solve(&program.device, b.data(), u.data(), u.size(), kLongestWait), HVP_OK);
  }
  ASSERT_EQ(hvp_board_config_read(program.board, 0, 4), 0x4850'1172U);
  const hvp_status said = hvp_solve(&program.device, b.data(), u.data(), u.size(), kLongestWait);
  const std::uint64_t ended = hvp_board_now_ps(program.board);
  EXPECT_EQ(hvp_status_name(said), std::string("HVP_ERROR_BUS"));
  for (const std::uint32_t at : {0U, 4U, 0x34U, 0x40U}) {
    EXPECT_EQ(hvp_board_config_read(program.board, at, 4), 0xffff'ffffU) << at;
  }
  hvp_board_config_write(program.board, 4, 0, 2);
  EXPECT_FALSE(hvp_board_interrupt(program.board));
  EXPECT_EQ(hvp_reset(&program.device), HVP_ERROR_BUS);
  std::uint32_t id = 0;
  hvp_board_read(program.board, 0, &id, sizeof id);
  EXPECT_EQ(id, 0xffff'ffffU);
  hvp_board_job job{};
  ASSERT_TRUE(hvp_board_last_job(program.board, &job));
  EXPECT_EQ(job.number, static_cast<std::uint64_t>(kFaultyJob));
  EXPECT_EQ(job.end_ps, ended);
  EXPECT_EQ(hvp_status_name(job.status), std::string("HVP_ERROR_BUS"));
  hvp_board_run_until_ps(program.board, hvp_board_now_ps(program.board) + 1'000'000'000'000);
  EXPECT_EQ(hvp_board_config_read(program.board, 0, 4), 0xffff'ffffU);
  EXPECT_FALSE(hvp_board_interrupt(program.board));
}

INSTANTIATE_TEST_SUITE_P(All, Removal, testing::ValuesIn(all_removals()), name_of);

// What a host does to a job on its own, without a fault of the scenario.
class OwnFault : public testing::Test {
 protected:
  void start(bool dma, const char* notification = "intx") {
    program.emplace(Parameters{fault_cases().front(), dma, notification, false});
    ASSERT_NE(program->board, nullptr) << program->why.data();
    ASSERT_EQ(program->open(), HVP_OK);
    ASSERT_EQ(hvp_solve(&program->device, b.data(), u.data(), u.size(), kLongestWait), HVP_OK);
    began = hvp_board_now_ps(program->board);
    ASSERT_EQ(hvp_write_rhs(&program->device, b.data(), b.size()), HVP_OK);
    ASSERT_EQ(hvp_start(&program->device), HVP_OK);
  }
  void expect_failed(hvp_status status, std::uint64_t ended) {
    hvp_board_job job{};
    ASSERT_TRUE(hvp_board_last_job(program->board, &job));
    EXPECT_EQ(job.number, 1U);
    EXPECT_EQ(job.begin_ps, began);
    EXPECT_EQ(job.end_ps, ended);
    EXPECT_EQ(hvp_status_name(job.status), std::string(hvp_status_name(status)));
  }

  std::optional<Program> program;
  std::array<std::int32_t, kUnknowns> b = {640, 640, 640, 640, 640, 640};
  std::array<std::int32_t, kUnknowns> u{};
  std::uint64_t began = 0;
};

TEST_F(OwnFault, AnAccessThatIsRefusedFailsTheJob) {
  start(false);
  std::uint16_t half = 0;
  hvp_board_read(program->board, 0, &half, sizeof half);
  EXPECT_EQ(hvp_wait(&program->device, kLongestWait), HVP_ERROR_ILLEGAL_ACCESS);
  const std::uint64_t ended = hvp_board_now_ps(program->board);
  ASSERT_EQ(hvp_reset(&program->device), HVP_OK);
  expect_failed(HVP_ERROR_ILLEGAL_ACCESS, ended);
}

TEST_F(OwnFault, MemoryThatIsTakenAwayFailsTheJob) {
  start(true);
  ASSERT_TRUE(hvp_board_unmap(program->board, 0x1000'0000, 1024));
  EXPECT_EQ(hvp_wait(&program->device, kLongestWait), HVP_ERROR_DMA);
  expect_failed(HVP_ERROR_DMA, hvp_board_now_ps(program->board));
}

TEST_F(OwnFault, AResetWhileBusyFailsTheJob) {
  start(false);
  const std::uint64_t ended = hvp_board_now_ps(program->board);
  ASSERT_EQ(hvp_reset(&program->device), HVP_OK);
  expect_failed(HVP_ERROR_TIMEOUT, ended);
}

TEST_F(OwnFault, AResetOfTheFunctionWhileBusyFailsTheJob) {
  start(false);
  const std::uint64_t ended = hvp_board_now_ps(program->board);
  hvp_board_config_write(program->board, 0x74, 1, 1);
  expect_failed(HVP_ERROR_TIMEOUT, ended);
}

TEST_F(OwnFault, ATimeOutAndAResetFailTheJob) {
  start(true);
  EXPECT_EQ(hvp_wait(&program->device, 1000), HVP_ERROR_TIMEOUT);
  const std::uint64_t ended = hvp_board_now_ps(program->board);
  ASSERT_EQ(hvp_reset(&program->device), HVP_OK);
  expect_failed(HVP_ERROR_TIMEOUT, ended);
}

// The board ends the job later; the host was told that it is busy, and gave it up.
TEST_F(OwnFault, AJobThatWasGivenUpFails) {
  start(true);
  EXPECT_EQ(hvp_wait(&program->device, 1000), HVP_ERROR_TIMEOUT);
  hvp_board_run_until_ps(program->board, hvp_board_now_ps(program->board) + 3'000'000'000);
  const std::uint64_t ended = hvp_board_now_ps(program->board);
  ASSERT_EQ(hvp_reset(&program->device), HVP_OK);
  expect_failed(HVP_ERROR_TIMEOUT, ended);
}

// Only who takes no interrupt any more has given up.
TEST_F(OwnFault, AWaitThatIsRepeatedFailsNoJob) {
  start(true, "msi");
  EXPECT_EQ(hvp_wait(&program->device, 1000), HVP_ERROR_TIMEOUT);
  EXPECT_EQ(hvp_wait(&program->device, kLongestWait), HVP_OK);
  const std::uint64_t ended = hvp_board_now_ps(program->board);
  ASSERT_EQ(hvp_reset(&program->device), HVP_OK);
  hvp_board_job job{};
  ASSERT_TRUE(hvp_board_last_job(program->board, &job));
  EXPECT_EQ(job.end_ps, ended);
  EXPECT_EQ(hvp_status_name(job.status), std::string("HVP_OK"));
}

// By blocks nothing of the job is in the host's memory: a host that never looks sees no end.
TEST_F(OwnFault, AnEndThatNobodySawIsNone) {
  start(false);
  const std::uint32_t none = 0;
  hvp_board_write(program->board, 0x2c, &none, sizeof none);  // INTERRUPT_ENABLE
  hvp_board_run_until_ps(program->board, hvp_board_now_ps(program->board) + 3'000'000'000);
  const std::uint64_t ended = hvp_board_now_ps(program->board);
  ASSERT_EQ(hvp_reset(&program->device), HVP_OK);
  expect_failed(HVP_ERROR_TIMEOUT, ended);
}

// What the board refuses while it is busy belongs to the job under way.
TEST_F(OwnFault, ARefusedStartCutsNoJob) {
  start(false);
  const std::uint32_t command = 1;
  hvp_board_write(program->board, 0x20, &command, sizeof command);
  EXPECT_EQ(hvp_wait(&program->device, kLongestWait), HVP_ERROR_ILLEGAL_ACCESS);
  const std::uint64_t ended = hvp_board_now_ps(program->board);
  ASSERT_EQ(hvp_reset(&program->device), HVP_OK);
  expect_failed(HVP_ERROR_ILLEGAL_ACCESS, ended);
}

// The last access of a job by DMA over PCI Express is a posted write.
TEST_F(OwnFault, TheLastJobIsThereThoughItsLastWriteIsUnderWay) {
  program.emplace(Parameters{fault_cases().front(), true, "intx", true});
  ASSERT_NE(program->board, nullptr) << program->why.data();
  ASSERT_EQ(program->open(), HVP_OK);
  for (std::uint64_t n = 0; n < 3; ++n) {
    ASSERT_EQ(hvp_solve(&program->device, b.data(), u.data(), u.size(), kLongestWait), HVP_OK);
    hvp_board_job job{};
    ASSERT_TRUE(hvp_board_last_job(program->board, &job));
    EXPECT_EQ(job.number, n);
  }
}

// Each fault that did not happen is named, with why, when the board is closed.
TEST(NeverStruck, IsSaid) {
  const std::array<const char*, 8> keys = {
      "fault[0].kind=device-gone",   "fault[0].frame=100",         "fault[1].kind=lost-interrupt",
      "fault[1].rate=0.001",         "fault[2].kind=master-abort", "fault[2].frame=0",
      "fault[2].access=acknowledge", "transfer.notification=intx"};
  std::array<char, 256> why{};
  const hvp_board_options options = {keys.data(), keys.size(), nullptr, false, nullptr};
  hvp_board* const board = hvp_board_open(kScenario, &options, why.data(), why.size());
  ASSERT_NE(board, nullptr) << why.data();
  const std::uint32_t start = 1;
  hvp_board_write(board, 0x20, &start, sizeof start);
  testing::internal::CaptureStderr();
  hvp_board_close(board);
  EXPECT_EQ(
      testing::internal::GetCapturedStderr(),
      "warning: [[fault]] device-gone did not happen: it is asked for in frame 100, and there "
      "were 1\n"
      "warning: [[fault]] lost-interrupt did not happen: at a rate of 0.001 none was drawn in 1 "
      "frames\n"
      "warning: [[fault]] master-abort did not happen: in frame 0 no such access was made\n");
}

INSTANTIATE_TEST_SUITE_P(All, JobRecord, testing::ValuesIn(all_parameters()), name_of);

}  // namespace
}  // namespace hvp::test
