// A host that is this test itself, not a process of SystemC: it goes through the board as a kernel
// does, at the board's exact times.
#include "vp/function/outside_host.h"

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "driver/hvp_driver.h"
#include "tests/vp/child_output.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/function/outside_host_rig.h"

namespace hvp::vp::outside_host_test {
namespace {

using test::kUs;

TEST(OutsideHost, NothingAnswersBeforeMemorySpaceIsOn) {
  Host host;
  EXPECT_EQ(host.read(Register::id), 0xffff'ffffU);
  EXPECT_EQ(now_ps(), 0);
  host.command(kMemorySpace);
  EXPECT_EQ(host.read(Register::id), 0x4856'5031U);
  EXPECT_EQ(now_ps(), test::pci_read(4));
  EXPECT_EQ(host.read(kBarBytes), 0xffff'ffffU);
  EXPECT_EQ(host.read(kBarBytes - 2), 0xffff'ffffU);
  EXPECT_EQ(now_ps(), test::pci_read(4));
}

TEST(OutsideHost, SizesOfAnAccess) {
  Host host;
  host.command(kMemorySpace);
  std::array<std::uint32_t, 2> pair{};
  EXPECT_TRUE(host.host->access(Command::read, 0, Host::bytes(pair)));
  EXPECT_EQ(pair, (std::array<std::uint32_t, 2>{0x4856'5031, 0x0002'0004}));
  EXPECT_EQ(host.side->board()->accelerator().illegal_accesses(), 0);
  for (const std::size_t size : {1U, 2U}) {
    std::array<std::uint8_t, 2> data{};
    EXPECT_TRUE(host.host->access(Command::read, 0, std::span(data).first(size)));
    EXPECT_EQ(data[0], 0xff);
    // docs/registers.md: not a whole word.
    EXPECT_EQ(host.read(Register::error), static_cast<std::uint32_t>(ErrorCode::illegal_access));
    host.write(Register::interrupt_status, 2);
  }
}

TEST(OutsideHost, TheDriverSolvesAtExactTimes) {
  Loaded host;
  ASSERT_EQ(hvp_write_rhs(&host.device, host.b.data(), host.b.size()), HVP_OK);
  const Picoseconds began = now_ps();
  ASSERT_EQ(hvp_start(&host.device), HVP_OK);
  const Picoseconds started = now_ps();
  EXPECT_EQ(started, began + test::pci_write(4));
  ASSERT_EQ(hvp_wait(&host.device, 100'000'000), HVP_OK);
  const auto& k = host.scene.computation.board().matrix();
  EXPECT_EQ(host.woken, started + test::solve_time(k.row_begin, 60));
  EXPECT_EQ(now_ps(), host.woken + test::pci_read(4) + test::pci_write(4));
  ASSERT_EQ(hvp_read_solution(&host.device, host.u.data(), host.u.size()), HVP_OK);
  EXPECT_EQ(host.u, host.expected());
  EXPECT_EQ(host.lines, (std::vector<bool>{true, false, true, false}));  // K's check, and the job
}

// Spans of a job sum to its time, and its chain goes through the board.
TEST(OutsideHost, AJobIsAFrameOfTheLedger) {
  Loaded host;
  for (int job = 0; job < 3; ++job) {
    const Picoseconds began = now_ps();
    ASSERT_EQ(hvp_solve(&host.device, host.b.data(), host.u.data(), host.u.size(), 100'000'000),
              HVP_OK);
    const Picoseconds took = now_ps() - began;
    // What the host does after a job belongs to none before it begins the next one.
    host.host->run_until(now_ps() + 7 * kUs);
    if (job == 2) host.host->frames().finish();
    if (job == 0) continue;
    const Frame& frame = host.log.frames.at(static_cast<std::size_t>(job) - 1);
    EXPECT_EQ(frame.number, job - 1);
    EXPECT_EQ(frame.latency(), took);
  }
  ASSERT_EQ(host.log.frames.size(), 3U);
  const std::vector<Span>& spans = host.log.frames.back().spans;
  std::vector<Phase> phases;
  for (const SpanId id : host.log.paths.back()) {
    phases.push_back(spans.at(static_cast<std::size_t>(id)).phase);
  }
  EXPECT_EQ(phases, (std::vector<Phase>{Phase::block_write, Phase::bus_write, Phase::solve,
                                        Phase::bus_read, Phase::bus_write, Phase::block_read}));
}

struct Refusal {
  bool pcie;
  bool messages;
};
class RefusedRead : public testing::TestWithParam<Refusal> {};

// The interrupt comes before the read's answer, and the host goes on from it: the frame's chain
// holds, and its spans sum to its time.
TEST_P(RefusedRead, InterruptsInTheMiddleOfAJob) {
  Loaded host([](PlatformSettings& settings) {
    if (GetParam().pcie) settings.bus.pcie.emplace();
    if (GetParam().messages) settings.transfer.notification = link::Notification::msi;
  });
  if (GetParam().messages) {
    host.write_config(ConfigSpace::kMessageAt + 4, kMessageAddress, 4);
    host.write_config(ConfigSpace::kMessageAt + 2, 1, 2);
  }
  ASSERT_EQ(hvp_write_rhs(&host.device, host.b.data(), host.b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&host.device), HVP_OK);
  const std::uint32_t enabled = host.read(Register::interrupt_enable);
  ASSERT_NE(enabled, 0U);
  EXPECT_EQ(host.read(offset_of(Aperture::u)), ~0U);
  EXPECT_EQ(hvp_wait(&host.device, 100'000'000), HVP_ERROR_ILLEGAL_ACCESS);
  host.host->run_until(now_ps() + 1000 * kUs);
  host.host->frames().finish();
  ASSERT_EQ(host.log.frames.size(), 1U);
  EXPECT_EQ(host.log.frames[0].status, HVP_ERROR_ILLEGAL_ACCESS);
}

INSTANTIATE_TEST_SUITE_P(All, RefusedRead,
                         testing::Values(Refusal{false, false}, Refusal{false, true},
                                         Refusal{true, false}, Refusal{true, true}));

TEST(OutsideHost, MessagesAreMaskedAndPending) {
  Loaded host([](PlatformSettings& settings) {
    settings.transfer.method = Transfer::Method::dma;
    settings.transfer.notification = link::Notification::msi;
  });
  // Not enabled: K's check came over the line.
  EXPECT_EQ(host.lines, (std::vector<bool>{true, false}));
  constexpr std::uint64_t kMessageAt = ConfigSpace::kMessageAt;
  host.write_config(kMessageAt + 4, 0xfee0'1000, 4);
  host.write_config(kMessageAt + 12, 0x31, 2);
  host.write_config(kMessageAt + 16, 1, 4);
  host.write_config(kMessageAt + 2, 1, 2);
  ASSERT_EQ(hvp_write_rhs(&host.device, host.b.data(), host.b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&host.device), HVP_OK);
  EXPECT_TRUE(host.host->run_until(now_ps() + 10'000 * kUs));
  std::array<std::uint8_t, 4> pending{};
  host.host->config().read(kMessageAt + 20, pending);
  EXPECT_EQ(pending[0], 1);
  EXPECT_TRUE(host.messages.empty());
  host.write_config(kMessageAt + 16, 0, 4);
  ASSERT_EQ(host.messages.size(), 1U);
  EXPECT_EQ(host.messages[0].address, 0xfee0'1000U);
  EXPECT_EQ(host.messages[0].data, 0x31);
  EXPECT_EQ(host.lines, (std::vector<bool>{true, false}));
}

void with_table(PlatformSettings& settings) {
  settings.transfer.method = Transfer::Method::dma;
  settings.transfer.notification = link::Notification::msi;
  settings.function = PciFunction{.msi_x = true};
}

constexpr std::uint64_t kTableControl = ConfigSpace::kMessageTableAt + 2;

// By the vector's mask, and by that of the function.
TEST(OutsideHost, MessagesOfATableAreMaskedAndPending) {
  Loaded host(with_table);
  host.write_table(0, 0xfee0'1000);
  host.write_table(8, 0x1'0031);
  host.write_config(kTableControl, 0x8000, 2);  // the vector is masked yet
  EXPECT_EQ(host.lines, (std::vector<bool>{true, false}));
  for (const bool by_function : {false, true}) {
    ASSERT_EQ(hvp_write_rhs(&host.device, host.b.data(), host.b.size()), HVP_OK);
    ASSERT_EQ(hvp_start(&host.device), HVP_OK);
    EXPECT_TRUE(host.host->run_until(now_ps() + 10'000 * kUs));
    EXPECT_TRUE(host.messages.empty());
    EXPECT_EQ(host.read_table(MessageTable::kPendingAt), 1U);
    const Picoseconds before = now_ps();
    if (by_function) {
      host.write_config(kTableControl, 0x8000, 2);
    } else {
      host.write_table(MessageTable::kControlAt, 0);
    }
    ASSERT_EQ(host.messages.size(), 1U);
    EXPECT_EQ(now_ps(), before);
    EXPECT_EQ(host.messages[0].address, 0xfee0'1000U);
    EXPECT_EQ(host.messages[0].data, 0x1'0031U);
    EXPECT_EQ(host.read_table(MessageTable::kPendingAt), 0U);
    ASSERT_EQ(hvp_wait(&host.device, 0), HVP_OK);
    host.messages.clear();
    host.write_config(kTableControl, 0xc000, 2);
  }
  EXPECT_EQ(host.lines, (std::vector<bool>{true, false}));
}

// When a job's message came, and when the driver was through.
std::string times_of_a_job(const std::function<void(PlatformSettings&)>& change) {
  return test::output_of_child([&change](std::string& text) {
    Loaded host(change);
    host.write_config(ConfigSpace::kMessageAt + 4, kMessageAddress, 4);
    host.write_config(ConfigSpace::kMessageAt + 2, 1, 2);
    host.write_table(0, static_cast<std::uint32_t>(kMessageAddress));
    host.write_table(MessageTable::kControlAt, 0);
    host.write_config(kTableControl, 0x8000, 2);
    const hvp_status status =
        hvp_solve(&host.device, host.b.data(), host.u.data(), host.u.size(), 100'000'000);
    text = std::to_string(status) + ' ' + std::to_string(host.woken) + ' ' +
           std::to_string(now_ps()) + ' ' + std::to_string(host.lines.size());
  });
}

TEST(OutsideHost, AMessageOfATableTakesAsLongAsAnother) {
  for (const bool pcie : {false, true}) {
    const auto with = [pcie](bool table) {
      return [pcie, table](PlatformSettings& settings) {
        with_table(settings);
        if (!table) settings.function.reset();
        if (pcie) settings.bus.pcie.emplace();
      };
    };
    const std::string expected = times_of_a_job(with(false));
    ASSERT_EQ(expected.substr(0, 2), "0 ");
    EXPECT_EQ(expected.back(), '2');  // the line of the matrix' check, up and down
    EXPECT_EQ(times_of_a_job(with(true)), expected);
  }
}

TEST(OutsideHost, ALineIsHeldBackByInterruptDisable) {
  Loaded host;
  host.command(kMemorySpace | 0x400U);
  ASSERT_EQ(hvp_write_rhs(&host.device, host.b.data(), host.b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&host.device), HVP_OK);
  EXPECT_TRUE(host.host->run_until(now_ps() + 10'000 * kUs));
  EXPECT_FALSE(host.host->line_is_up());
  std::array<std::uint8_t, 2> status{};
  host.host->config().read(6, status);
  EXPECT_EQ(status[0] & 8U, 8U);
  host.command(kMemorySpace);
  EXPECT_TRUE(host.host->line_is_up());
}

TEST(OutsideHost, TheBoardMovesDataInTheHostsOwnMemory) {
  Loaded host(with_dma);
  GuestMemory memory(host);
  ASSERT_EQ(hvp_use_dma(&host.device, &memory.dma), HVP_OK);
  ASSERT_EQ(hvp_solve(&host.device, host.b.data(), host.u.data(), host.u.size(), 100'000'000),
            HVP_OK);
  EXPECT_EQ(host.u, host.expected());
}

TEST(OutsideHost, ABoardThatMayNotMasterFailsWithDma) {
  Loaded host(with_dma);
  GuestMemory memory(host);
  ASSERT_EQ(hvp_use_dma(&host.device, &memory.dma), HVP_OK);
  host.command(kMemorySpace);
  EXPECT_EQ(hvp_solve(&host.device, host.b.data(), host.u.data(), host.u.size(), 100'000'000),
            HVP_ERROR_DMA);
  host.command(kMemorySpace | kMaster);
  EXPECT_EQ(hvp_solve(&host.device, host.b.data(), host.u.data(), host.u.size(), 100'000'000),
            HVP_OK);
}

TEST(OutsideHost, MemoryThatIsTakenAwayIsADmaError) {
  Loaded host(with_dma);
  GuestMemory memory(host);
  ASSERT_EQ(hvp_use_dma(&host.device, &memory.dma), HVP_OK);
  ASSERT_EQ(hvp_write_rhs(&host.device, host.b.data(), host.b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&host.device), HVP_OK);
  host.host->run_until(now_ps() + 50 * kUs);  // b is on the board
  EXPECT_TRUE(host.side->board()->memory()->unmap(GuestMemory::kHigh, 4096));
  EXPECT_EQ(hvp_wait(&host.device, 100'000'000), HVP_ERROR_DMA);
}

TEST(OutsideHost, AResetOfTheFunctionForgetsTheMatrix) {
  Loaded host;
  EXPECT_EQ(host.read(Register::status) & field::kStatusMatrixLoaded.mask(),
            field::kStatusMatrixLoaded.mask());
  host.write_config(ConfigSpace::kFeaturesAt + 4, 1, 1);
  EXPECT_EQ(host.read(Register::status), 0xffff'ffffU);
  host.command(kMemorySpace);
  EXPECT_EQ(host.read(Register::status), 0U);
}

}  // namespace
}  // namespace hvp::vp::outside_host_test
