// Which flag a fault raises: by the error that the driver returned, and none where it was put right
// or nobody could know.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/stability/flag.h"
#include "tests/vp/child_output.h"
#include "tests/vp/pressed_scene.h"
#include "vp/host/loop_health.h"

namespace hvp::vp::fault_flag_test {
namespace {

using link::Notification;
using stability::Flag;
using test::PressedScene;
using test::SimulatedRenewal;
using test::SmallScene;
using Method = Transfer::Method;

struct Row {
  FaultKind kind;
  FaultAccess access = FaultAccess::first;
  std::string flag = "";   // its name; empty: none
  std::string error = "";  // the driver's name of what it returned; empty: none, or put right
  bool dma = false;
  bool pcie = false;
  int bits = 0;
};

constexpr std::int64_t kAt = 14;

void configure(PlatformSettings& settings, const Row& row) {
  Fault fault;
  fault.kind = row.kind;
  fault.frame = kAt;
  fault.access = row.access;
  fault.bits = row.bits;
  fault.delay_s = row.kind == FaultKind::late_dma ? 5e-3 : 0;
  fault.bytes = row.kind == FaultKind::truncated_dma ? 8 : 0;
  settings.faults = {fault};
  settings.host.timeout_s = 1e-3;
  settings.frames = 40;
  if (row.pcie) {
    settings.bus.pcie.emplace();
    settings.transfer.method = Method::programmed_io;
    settings.transfer.notification = Notification::msi;
  }
  if (!row.dma) return;
  settings.transfer.method = Method::dma;
  settings.transfer.dma.emplace();
}

// The flags of the driver's errors that the frames of a run raised, and what it returned first.
template <class Run>
std::string told(const Run& run) {
  stability::Flags flags;
  for (const Frame& frame : run.log.frames) flags.merge(stability::Flags(frame.flags));
  std::string text;
  for (const Flag flag :
       {Flag::solver_timeout, Flag::bus_error, Flag::board_error, Flag::saturation}) {
    if (flags.has(flag)) text += std::string(describe(flag).name) + " ";
  }
  EXPECT_EQ(run.platform.faults()->records().front().injected, 1);
  const Frame& hit = run.log.frames[kAt];
  if (!hit.solved()) text += hvp_status_name(hit.status);
  return text;
}

std::string expected(const Row& row) {
  return (row.flag.empty() ? "" : row.flag + " ") + row.error;
}

std::string described(const Row& row) {
  return std::string(name(row.kind)) + " on " + name(row.access) + (row.dma ? ", DMA" : "") +
         (row.pcie ? ", PCI Express" : "") + (row.bits > 1 ? ", even" : "");
}

TEST(FaultFlag, OfAFrameIsThatOfTheDriversError) {
  using enum FaultKind;
  using Access = FaultAccess;
  const std::string bus = "bus-error";
  const std::string late = "solver-timeout";
  const std::vector<Row> rows = {
      {.kind = lost_interrupt},
      {.kind = stuck_busy, .flag = late, .error = "HVP_ERROR_TIMEOUT"},
      {.kind = stuck_busy, .flag = late, .error = "HVP_ERROR_TIMEOUT", .dma = true},
      {.kind = saturated_solve, .flag = "saturation", .error = "HVP_ERROR_SATURATED"},
      {.kind = function_level_reset, .flag = late, .error = "HVP_ERROR_TIMEOUT"},
      {.kind = master_abort, .access = Access::rhs, .flag = bus, .error = "HVP_ERROR_BUS"},
      {.kind = master_abort, .access = Access::start, .flag = bus, .error = "HVP_ERROR_BUS"},
      {.kind = master_abort, .access = Access::status},
      {.kind = master_abort, .access = Access::acknowledge},
      {.kind = master_abort, .access = Access::solution},
      // The root port hears of no write: the board is waited for, or found idle.
      {.kind = master_abort,
       .access = Access::start,
       .flag = late,
       .error = "HVP_ERROR_TIMEOUT",
       .pcie = true},
      {.kind = corrupted_word, .access = Access::rhs, .flag = bus, .error = "HVP_ERROR_DATA"},
      {.kind = corrupted_word, .access = Access::rhs, .bits = 2},
      {.kind = corrupted_word, .access = Access::solution},
      {.kind = corrupted_word, .access = Access::rhs, .pcie = true},
      {.kind = device_gone, .flag = bus, .error = "HVP_ERROR_BUS"},
      {.kind = surprise_removal, .flag = bus, .error = "HVP_ERROR_BUS"},
      {.kind = late_dma, .flag = late, .error = "HVP_ERROR_TIMEOUT", .dma = true},
      {.kind = truncated_dma, .flag = bus, .error = "HVP_ERROR_SHORT_TRANSFER", .dma = true},
      {.kind = aer_correctable, .access = Access::start, .pcie = true},
      {.kind = aer_uncorrectable,
       .access = Access::rhs,
       .flag = bus,
       .error = "HVP_ERROR_DATA",
       .pcie = true},
      {.kind = aer_uncorrectable,
       .access = Access::start,
       .flag = bus,
       .error = "HVP_ERROR_DATA",
       .pcie = true},
  };
  for (const Row& row : rows) {
    const std::string found = test::output_of_child([&row](std::string& out) {
      SmallScene scene;
      scene.touch();
      configure(scene.settings, row);
      out = told(test::Simulated(scene));
      if (testing::Test::HasFailure()) out = "failed";
    });
    EXPECT_EQ(found, expected(row)) << described(row);
  }
}

// The frame has its force. The flag is of the error that lost the new matrix, and the frames that
// are held until the board is set up again have the same.
TEST(FaultFlag, OfARenewalIsThatOfTheDriversError) {
  using enum FaultKind;
  const std::string bus = "bus-error";
  const std::vector<Row> rows = {
      {.kind = master_abort, .flag = bus},
      {.kind = corrupted_word, .flag = bus},
      {.kind = corrupted_word, .bits = 2},
      {.kind = surprise_removal, .flag = bus},
      {.kind = aer_correctable, .pcie = true},
      {.kind = aer_uncorrectable, .flag = bus, .pcie = true},
      {.kind = corrupted_word, .pcie = true},
      {.kind = master_abort, .flag = bus, .dma = true},
      {.kind = corrupted_word, .flag = bus, .dma = true},
      {.kind = corrupted_word, .dma = true, .bits = 2},
      {.kind = surprise_removal, .flag = bus, .dma = true},
      {.kind = master_abort, .flag = bus, .dma = true, .pcie = true},
      {.kind = aer_correctable, .dma = true, .pcie = true},
      {.kind = aer_uncorrectable, .flag = bus, .dma = true, .pcie = true},
      {.kind = corrupted_word, .dma = true, .pcie = true},
  };
  for (Row row : rows) {
    row.access = FaultAccess::values;
    const std::string found = test::output_of_child([&row](std::string& out) {
      PressedScene scene({});
      configure(scene.settings, row);
      const SimulatedRenewal run(scene);
      out = told(run);
      // None of them is a time-out, but of a board that is not there any more.
      EXPECT_EQ(run.platform.servo().counts().errors[HVP_ERROR_TIMEOUT].count, 0);
      if (testing::Test::HasFailure()) out = "failed";
    });
    EXPECT_EQ(found, expected(row)) << described(row);
  }
}

TEST(FaultFlag, EveryErrorHasOne) {
  for (int status = HVP_OK + 1; status < HVP_STATUS_COUNT; ++status) {
    const Flag flag = flag_of(static_cast<hvp_status>(status));
    EXPECT_TRUE(flag == Flag::solver_timeout || flag == Flag::bus_error ||
                flag == Flag::board_error || flag == Flag::saturation);
  }
  EXPECT_EQ(flag_of(HVP_ERROR_BAD_SETTING), Flag::board_error);
  EXPECT_EQ(flag_of(HVP_ERROR_BOARD), Flag::board_error);
  EXPECT_EQ(flag_of(HVP_ERROR_DMA), Flag::bus_error);
}

}  // namespace
}  // namespace hvp::vp::fault_flag_test
