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

// What a session says of the configuration space, and how it resets the function.
TEST(BoardPort, HasTheFunctionThatTheScenarioAsksFor) {
  test::SmallScene scene;
  scene.settings.bus.pcie.emplace();
  scene.settings.transfer.method = vp::Transfer::Method::programmed_io;
  scene.settings.function = vp::PciFunction{.pci_express = true, .bar_bits = 64};
  BoardPort port(scene.settings);
  EXPECT_EQ(port.config_bytes(), 4096U);
  const std::array<std::uint8_t, 4> ones = {0xff, 0xff, 0xff, 0xff};
  std::array<std::uint8_t, 4> word{};
  port.write_config(0x10, ones);
  port.write_config(0x14, ones);
  port.read_config(0x10, word);
  EXPECT_EQ(word, (std::array<std::uint8_t, 4>{4, 0, 0, 0xfe}));
  port.read_config(0x14, word);
  EXPECT_EQ(word, ones);
  port.read_config(0x80, word);
  EXPECT_EQ(word[0], 0x10);
  write_command(port);
  port.reset();
  port.read_config(4, word);
  EXPECT_EQ(word[0], 0);
  port.read_config(0x14, word);
  EXPECT_EQ(word[0], 0);
}

// The client hears of an uncorrectable error where Device Control wants it reported.
TEST(BoardPort, TellsOfErrorsOfALink) {
  test::SmallScene scene;
  scene.settings.bus.pcie.emplace();
  scene.settings.transfer.method = vp::Transfer::Method::programmed_io;
  scene.settings.function = vp::PciFunction{.pci_express = true};
  for (const std::int64_t frame : {0, 1}) {
    vp::Fault fault;
    fault.kind = vp::FaultKind::aer_uncorrectable;
    fault.frame = frame;
    scene.settings.faults.push_back(fault);
  }
  BoardPort port(scene.settings);
  EXPECT_TRUE(port.reports_errors());
  Interrupts interrupts(std::nullopt, true);
  port.tell(&interrupts);
  const FileDescriptor event = test::eventfd();
  std::vector<FileDescriptor> files;
  files.push_back(test::copy_of(event));
  interrupts.set({.argsz = sizeof(SetInterrupts),
                  .flags = kDataEventfd | kActionTrigger,
                  .index = kErrorIndex,
                  .start = 0,
                  .count = 1},
                 {}, std::move(files));
  write_command(port);
  const std::array<std::uint8_t, 4> word = {1, 0, 0, 0};
  const std::array<std::uint8_t, 4> start = {1, 0, 0, 0};
  const auto job = [&] {
    EXPECT_TRUE(port.write_bar(0x20000, word));  // B
    EXPECT_TRUE(port.write_bar(0x20, start));    // CONTROL
    while (port.has_work()) port.advance();
  };
  job();
  EXPECT_EQ(test::signals(event), 0U);
  std::array<std::uint8_t, 4> status{};
  port.read_config(0x104, status);
  EXPECT_EQ(status, (std::array<std::uint8_t, 4>{0, 0x10, 0, 0}));
  port.write_config(0x88, std::array<std::uint8_t, 1>{2});
  job();
  EXPECT_EQ(test::signals(event), 1U);
}

}  // namespace
}  // namespace hvp::serve::board_port_test
