// The board's side without the processes of the host: the driver runs in a program of the test's
// own, and simulated time goes forward in steps from outside.
#include "vp/board/board_side.h"

#include <array>
#include <functional>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "driver/hvp_driver.h"
#include "models/fixed/reference_solver.h"
#include "tests/vp/board_master.h"
#include "tests/vp/child_output.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/host/board_access.h"
#include "vp/host/dma_memory.h"
#include "vp/host/driver_config.h"
#include "vp/host/driver_port.h"

namespace hvp::vp::board_side_test {
namespace {

using test::kNs;
using test::kUs;
using test::SmallScene;

constexpr std::size_t kUnknowns = SmallScene::kUnknowns;
constexpr Picoseconds kInterruptLatency = 5 * kUs;

// A host that loads K and solves twice.
class Driven {
 public:
  explicit Driven(const std::function<void(PlatformSettings&)>& change = {}) {
    if (change) change(scene.settings);
    const std::size_t memory = DmaMemory::needed(
        scene.settings.transfer.engine(),
        DmaBytes::of(scene.settings.transfer, scene.settings.solver, kUnknowns, 0));
    side.emplace(scene.settings, Workload{.memory_bytes = memory}, session, ledger);
    const Transfer& transfer = scene.settings.transfer;
    access.emplace("access", transfer.notification == link::Notification::msi);
    port.emplace(*access, kInterruptLatency, ledger, nullptr, transfer);
    access->to_bus.bind(side->from_host());
    side->connect(*access);
    program.emplace("program", [this](test::Program&) { solve(); });
  }

  std::vector<std::int32_t> expected() const {
    std::vector<std::int32_t> solution(kUnknowns, 0);
    fixed::ReferenceSolver(scene.settings.solver)
        .solve(scene.computation.board().matrix(), {b, solution});
    return solution;
  }

  SmallScene scene;
  Ledger ledger;
  Session session;
  std::optional<BoardSide> side;
  std::optional<BoardAccess> access;
  std::optional<DriverPort> port;
  std::optional<test::Program> program;
  std::vector<std::int32_t> b = test::words(SmallScene::kUnknowns, 200);
  std::vector<std::int32_t> u = std::vector<std::int32_t>(kUnknowns);
  Picoseconds started = -1;
  Picoseconds solved = -1;

 private:
  void solve() {
    hvp_device device{};
    std::vector<std::uint32_t> scratch(kUnknowns);
    ASSERT_EQ(hvp_open(&device, &port->bus(), scratch.data(), scratch.size()), HVP_OK);
    std::optional<DmaMemory> segments;
    const Transfer& transfer = scene.settings.transfer;
    if (transfer.method == Transfer::Method::dma) {
      segments.emplace(*side->board()->memory(), transfer.engine(),
                       DmaBytes::of(transfer, scene.settings.solver, kUnknowns, 0));
      ASSERT_EQ(hvp_use_dma(&device, &segments->dma()), HVP_OK);
    }
    const hvp_solver_config config = driver_config(scene.settings.solver);
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    const fixed::QuantisedMatrix& k = scene.computation.board().matrix();
    const hvp_matrix matrix{static_cast<std::uint32_t>(k.block_rows()),
                            static_cast<std::uint32_t>(k.column.size()), k.row_begin.data(),
                            k.column.data(), k.value.data()};
    ASSERT_EQ(hvp_load_matrix(&device, &matrix), HVP_OK);
    ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
    ASSERT_EQ(hvp_start(&device), HVP_OK);
    started = now_ps();
    ASSERT_EQ(hvp_wait(&device, 100'000'000), HVP_OK);
    ASSERT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_OK);
    solved = now_ps();
  }
};

TEST(BoardSide, BuildsNoHost) {
  SmallScene scene;
  Ledger ledger;
  const Session session;
  const BoardSide side(scene.settings, {}, session, ledger);
  std::vector<std::string> names;
  for (const sc_core::sc_object* object : sc_core::sc_get_top_level_objects()) {
    if (dynamic_cast<const sc_core::sc_module*>(object) != nullptr) {
      names.emplace_back(object->name());
    }
  }
  EXPECT_EQ(names, (std::vector<std::string>{"bus", "accelerator", "daq"}));
}

TEST(BoardSide, TheDriverSolvesStepByStepAtExactTimes) {
  Driven host;
  while (host.started < 0) BoardSide::step_to(BoardSide::next_event().value());
  const auto& k = host.scene.computation.board().matrix();
  // Only the end of the job and the host's time-out are ahead.
  const Picoseconds end = host.started + test::solve_time(k.row_begin, 60);
  EXPECT_EQ(BoardSide::next_event(), end);
  const Picoseconds loaded = host.side->board()->accelerator().job_end().time;
  BoardSide::step_to(end - 1);
  EXPECT_EQ(now_ps(), end - 1);
  EXPECT_EQ(host.side->board()->accelerator().job_end().time, loaded);
  BoardSide::step_to(end);
  EXPECT_EQ(host.side->board()->accelerator().job_end().time, end);
  EXPECT_EQ(host.solved, -1);
  BoardSide::step_to(end + 1000 * kUs);
  EXPECT_EQ(host.solved, end + kInterruptLatency + test::pci_read(4) + test::pci_write(4) +
                             test::pci_read(2 * SmallScene::kUnknowns));
  EXPECT_EQ(host.u, host.expected());
  EXPECT_THROW(BoardSide::step_to(end), std::invalid_argument);
}

struct Way {
  const char* name;
  std::function<void(PlatformSettings&)> change;
};
void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }

std::string run_with(const Way& way, bool in_steps) {
  return test::output_of_child([&](std::string& text) {
    Driven host(way.change);
    if (!in_steps) BoardSide::step_to(1'000'000 * kUs);
    while (host.solved < 0) BoardSide::step_to(BoardSide::next_event().value());
    if (host.u == host.expected()) text = std::to_string(host.solved);
  });
}

class BoardSideWays : public testing::TestWithParam<Way> {};

TEST_P(BoardSideWays, StepsDoNotChangeWhatIsSimulated) {
  const std::string whole = run_with(GetParam(), false);
  EXPECT_FALSE(whole.empty());
  EXPECT_EQ(run_with(GetParam(), true), whole);
}

INSTANTIATE_TEST_SUITE_P(All, BoardSideWays,
                         testing::Values(Way{"Line", [](PlatformSettings&) {}},
                                         Way{"Polling",
                                             [](PlatformSettings& s) {
                                               s.transfer.notification =
                                                   link::Notification::polling;
                                             }},
                                         Way{"DmaOverALinkWithMessages",
                                             [](PlatformSettings& s) {
                                               s.bus.pcie.emplace();
                                               s.transfer.method = Transfer::Method::dma;
                                               s.transfer.notification = link::Notification::msi;
                                             }},
                                         Way{"CycleAccurate",
                                             [](PlatformSettings& s) {
                                               s.fidelity.accelerator = Timing::cycle_accurate;
                                             }}),
                         [](const testing::TestParamInfo<Way>& way) { return way.param.name; });

TEST(BoardSide, TheDeviceIsReadAndDriven) {
  SmallScene scene;
  Ledger ledger;
  const Session session;
  BoardSide side(scene.settings, {}, session, ledger);
  BoardAccess access("access");
  access.to_bus.bind(side.from_host());
  side.connect(access);
  std::array<std::int32_t, 3> position{};
  test::Program program("program", [&](test::Program&) {
    const std::uint32_t latch = 1;
    EXPECT_TRUE(access.write(kDaqBase + DaqBoard::kLatch, &latch, 4));
    EXPECT_TRUE(access.read(kDaqBase + DaqBoard::kPosition, position.data(), 12));
  });
  BoardSide::step_to(1000 * kUs);
  EXPECT_EQ(position, (std::array<std::int32_t, 3>{20'000'000, 20'000'000, 70'000'000}));
  EXPECT_EQ(BoardSide::next_event(), std::nullopt);
}

}  // namespace
}  // namespace hvp::vp::board_side_test
