// Solves that fail: the last force is held, the board is brought back, the run goes on.
#include <gtest/gtest.h>

#include "models/stability/flag.h"
#include "tests/vp/board_master.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/platform.h"

namespace hvp::vp::recovery_test {
namespace {

using test::FrameLog;
using test::kMs;
using test::kUs;
using test::SmallScene;

constexpr std::uint32_t bit(stability::Flag flag) {
  return std::uint32_t{1} << static_cast<unsigned>(flag);
}
constexpr std::uint32_t kTimeoutFlag = bit(stability::Flag::solver_timeout);
// An access that the board refused, although not the driver's.
constexpr std::uint32_t kBoardFlag = bit(stability::Flag::board_error);

struct Forces : FrameObserver {
  void solved(const Frame& frame, const Solution& solution) override {
    contact_nodes.push_back(frame.touch().contact.node);
    contact_sizes.push_back(solution.hold.nodes.size());
  }
  std::vector<int> contact_nodes;
  std::vector<std::size_t> contact_sizes;
};

TEST(Recovery, BoardThatIsTooSlowIsResetAfterEveryFrame) {
  SmallScene scene;
  scene.settings.host.timeout_s = 100e-6;
  scene.settings.frames = 5;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  FrameLog log;
  platform.add_observer(log);
  platform.run();

  // Latch, position, lookup, words of b, driver, b, start; the time-out and a look at STATUS.
  const Picoseconds latency = test::pci_write(4) + 1 * kUs + test::pci_read(12) + 1 * kUs +
                              test::compute(4.0 * SmallScene::kUnknowns) + 1 * kUs +
                              test::pci_write(2 * SmallScene::kUnknowns) + test::pci_write(4) +
                              100 * kUs + test::pci_read(4) + test::pci_write(12) + 10 * kUs;
  ASSERT_EQ(log.frames.size(), 5U);
  for (const Frame& frame : log.frames) {
    EXPECT_EQ(frame.latency(), latency);
    // Bringing the board back takes as long as set-up and belongs to the load.
    EXPECT_EQ(frame.work_done - frame.born, latency - 10 * kUs + platform.servo().set_up_time());
    EXPECT_EQ(frame.flags, kTimeoutFlag);
    EXPECT_EQ(frame.touch().force.norm(), 0);
  }
  EXPECT_EQ(platform.verdict().unsolved(), 5);
  EXPECT_FALSE(platform.verdict().force_in_time());
  EXPECT_EQ(platform.servo().counts().driver_errors, 5);
  EXPECT_EQ(platform.servo().counts().last_error, HVP_ERROR_TIMEOUT);
  EXPECT_EQ(platform.servo().counts().flags, kTimeoutFlag);
  EXPECT_EQ(platform.accelerator().illegal_accesses(), 0);
}

// Somebody else writes to a locked register while the solve of frame 20 runs. The error ends the
// host's wait; the frame holds the force of frame 19, and frame 21 has the contact again.
TEST(Recovery, ForceOfTheLastGoodFrameIsHeld) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 30;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  FrameLog log;
  Forces seen;
  platform.add_observer(log);
  platform.add_observer(seen);
  Picoseconds intrusion = 0;
  test::Program intruder("intruder", [&](test::Program& p) {
    while (platform.session().begin == 0) p.sleep(10 * kUs);
    intrusion = platform.session().begin + 40 * kMs + 100 * kUs;
    p.sleep_until(intrusion);
    EXPECT_EQ(platform.accelerator().bank().get(field::kStatusBusy), 1U);
    // Another agent of the bus, for which the platform has no socket.
    auto* board = dynamic_cast<tlm::tlm_fw_transport_if<>*>(
        const_cast<Accelerator&>(platform.accelerator()).from_bus.get_interface());
    ASSERT_NE(board, nullptr);
    tlm::tlm_generic_payload payload;
    std::uint32_t word = 1;
    payload.set_write();
    payload.set_address(test::offset_of(Register::iterations));
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
    payload.set_data_length(4);
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    board->b_transport(payload, delay);
    EXPECT_EQ(payload.get_response_status(), tlm::TLM_COMMAND_ERROR_RESPONSE);
  });
  platform.run();

  ASSERT_EQ(log.frames.size(), 30U);
  const Frame& good = log.frames[19];
  const Frame& bad = log.frames[20];
  const Frame& next = log.frames[21];
  EXPECT_EQ(good.flags & kBoardFlag, 0U);
  EXPECT_GT(good.touch().force.norm(), 0);
  EXPECT_EQ(bad.flags & (kBoardFlag | kTimeoutFlag), kBoardFlag);
  EXPECT_EQ(bad.touch().force, good.touch().force);
  EXPECT_EQ(bad.touch().contact.node, good.touch().contact.node);
  EXPECT_EQ(next.flags & kBoardFlag, 0U);
  EXPECT_EQ(next.touch().contact.node, good.touch().contact.node);
  EXPECT_GT(next.touch().force.norm(), 0);
  EXPECT_EQ(platform.servo().counts().driver_errors, 1);
  EXPECT_EQ(platform.servo().counts().last_error, HVP_ERROR_ILLEGAL_ACCESS);
  // Observers see the contact that the displacement belongs to.
  EXPECT_EQ(seen.contact_nodes[20], good.touch().contact.node);
  EXPECT_EQ(seen.contact_sizes[20], 1U);

  // The frame was woken by the error: its path goes through its own wait, until the intrusion.
  const std::vector<SpanId>& path = log.paths[20];
  const auto wait = std::find_if(path.begin(), path.end(), [&](SpanId id) {
    return bad.spans[static_cast<std::size_t>(id)].phase == Phase::wait;
  });
  ASSERT_NE(wait, path.end());
  EXPECT_EQ(bad.spans[static_cast<std::size_t>(*wait)].end, intrusion);
  EXPECT_EQ(platform.accelerator().illegal_accesses(), 1);
}

// A run without a frame has no misses either; it must not look like one that held its budget.
TEST(Recovery, BoardThatRefusesItsSettingsEndsTheRun) {
  SmallScene scene;
  scene.settings.solver.headroom_bits = 9;  // the board has room for eight
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  std::string what;
  try {
    platform.run();
  } catch (const std::runtime_error& e) {
    what = e.what();
  }
  EXPECT_EQ(what, std::string("the board could not be set up: ") +
                      hvp_status_text(HVP_ERROR_BAD_SETTING));
}

}  // namespace
}  // namespace hvp::vp::recovery_test
