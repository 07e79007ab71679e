// How far simulated time goes by itself.
#include "app/serve/board_port.h"

#include <array>

#include "tests/serve/session_client.h"
#include "tests/vp/small_scene.h"

namespace hvp::serve::board_port_test {
namespace {

using vp::now_ps;

vp::PlatformSettings with_traffic() {
  test::SmallScene scene;
  scene.settings.fidelity.bus = vp::Timing::approximately_timed;
  scene.settings.bus.traffic.emplace();
  return scene.settings;
}

void write_command(BoardPort& port) {
  const std::array<std::uint8_t, 1> memory_space = {2};
  port.write_config(4, memory_space);
}

TEST(BoardPort, EndlessEventsMoveNoTimeByThemselves) {
  BoardPort port(with_traffic());
  write_command(port);
  std::array<std::uint8_t, 4> word{};
  ASSERT_TRUE(port.read_bar(0, word));
  const vp::Picoseconds accessed = now_ps();
  int pieces = 0;
  for (; port.has_work(); ++pieces) port.advance();
  EXPECT_GT(pieces, 0);
  EXPECT_LE(now_ps(), accessed + BoardPort::kSettle + 100'000'000);
  EXPECT_FALSE(port.has_work());
  ASSERT_TRUE(port.read_bar(0, word));
  EXPECT_TRUE(port.has_work());
}

TEST(BoardPort, WithoutEventsNothingMoves) {
  const test::SmallScene scene;
  BoardPort port(scene.settings);
  write_command(port);
  std::array<std::uint8_t, 4> word{};
  ASSERT_TRUE(port.read_bar(0, word));
  while (port.has_work()) port.advance();
  const vp::Picoseconds accessed = now_ps();
  EXPECT_FALSE(port.has_work());
  EXPECT_EQ(now_ps(), accessed);
}

}  // namespace
}  // namespace hvp::serve::board_port_test
