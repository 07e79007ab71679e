#pragma once

// A host that is the test itself, not a process of SystemC: it goes through the board as a kernel
// does.
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "driver/hvp_driver.h"
#include "models/fixed/reference_solver.h"
#include "tests/vp/board_master.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/function/outside_host.h"
#include "vp/host/driver_config.h"

namespace hvp::vp::outside_host_test {

using test::SmallScene;

constexpr std::uint64_t kCommandRegister = 0x04;
constexpr std::uint16_t kMemorySpace = 2;
constexpr std::uint16_t kMaster = 4;

class Host : public InterruptListener {
 public:
  explicit Host(const std::function<void(PlatformSettings&)>& change = {}) {
    if (change) change(scene.settings);
    ledger.add_observer(log);
    side.emplace(scene.settings, Workload{}, session, ledger);
    host.emplace("host", scene.settings, *side, session, ledger);
    host->listen(*this);
  }

  void command(std::uint16_t value) { write_config(kCommandRegister, value, 2); }
  void write_config(std::uint64_t at, std::uint64_t value, std::size_t bytes) {
    std::array<std::uint8_t, 8> data{};
    for (std::size_t i = 0; i < bytes; ++i) data.at(i) = static_cast<std::uint8_t>(value >> 8 * i);
    EXPECT_TRUE(host->access(Command::write, at, std::span(data).first(bytes),
                             OutsideHost::Space::configuration));
  }
  std::uint32_t read_table(std::uint64_t at) {
    std::array<std::uint32_t, 1> word{};
    EXPECT_TRUE(host->access(Command::read, at, bytes(word), OutsideHost::Space::message_table));
    return word[0];
  }
  void write_table(std::uint64_t at, std::uint32_t value) {
    std::array<std::uint32_t, 1> word = {value};
    EXPECT_TRUE(host->access(Command::write, at, bytes(word), OutsideHost::Space::message_table));
  }
  std::uint32_t read(std::uint32_t offset) {
    std::array<std::uint32_t, 1> word{};
    EXPECT_TRUE(host->access(Command::read, offset, bytes(word)));
    return word[0];
  }
  void write(std::uint32_t offset, std::uint32_t value) {
    std::array<std::uint32_t, 1> word = {value};
    EXPECT_TRUE(host->access(Command::write, offset, bytes(word)));
  }
  std::uint32_t read_config(std::uint64_t at) {
    std::array<std::uint32_t, 1> word{};
    EXPECT_TRUE(host->access(Command::read, at, bytes(word), OutsideHost::Space::configuration));
    return word[0];
  }
  std::uint32_t read(Register reg) { return read(offset_of(reg)); }
  void write(Register reg, std::uint32_t value) { write(offset_of(reg), value); }
  template <class Words>
  static std::span<std::uint8_t> bytes(Words& words) {
    return {reinterpret_cast<std::uint8_t*>(words.data()), 4 * words.size()};
  }

  // The driver's way to the board.
  hvp_bus bus() {
    hvp_bus bus{};
    bus.context = this;
    bus.read32 = [](void* c, std::uint32_t at) noexcept { return self(c).read(at); };
    bus.write32 = [](void* c, std::uint32_t at, std::uint32_t v) noexcept { self(c).write(at, v); };
    bus.read_block = [](void* c, std::uint32_t at, std::uint32_t* words,
                        std::size_t count) noexcept {
      std::span<std::uint32_t> all(words, count);
      self(c).host->access(Command::read, at, bytes(all));
    };
    bus.write_block = [](void* c, std::uint32_t at, const std::uint32_t* words,
                         std::size_t count) noexcept {
      std::vector<std::uint32_t> all(words, words + count);
      self(c).host->access(Command::write, at, bytes(all));
    };
    bus.wait_interrupt = [](void* c, std::uint64_t timeout_ns) noexcept -> int {
      return self(c).sleep(timeout_ns) ? HVP_INTERRUPT : HVP_INTERRUPT_TIMED_OUT;
    };
    bus.now_ns = [](void*) noexcept { return static_cast<std::uint64_t>(now_ps() / 1000); };
    return bus;
  }

  bool sleep(std::uint64_t timeout_ns) {
    const Picoseconds late = now_ps() + static_cast<Picoseconds>(timeout_ns) * 1000;
    while (!host->line_is_up() && messages.empty() && !host->run_until(late)) continue;
    woken = now_ps();
    const bool heard = host->line_is_up() || !messages.empty();
    messages.clear();
    return heard;
  }

  void message(const ConfigSpace::Message& message) override { messages.push_back(message); }
  void line(bool up) override { lines.push_back(up); }

  static Host& self(void* context) { return *static_cast<Host*>(context); }

  SmallScene scene;
  test::FrameLog log;
  Ledger ledger;
  Session session;
  std::optional<BoardSide> side;
  std::optional<OutsideHost> host;
  std::vector<ConfigSpace::Message> messages;
  std::vector<bool> lines;
  Picoseconds woken = -1;
};

class Loaded : public Host {
 public:
  explicit Loaded(const std::function<void(PlatformSettings&)>& change = {}) : Host(change) {
    command(kMemorySpace | kMaster);
    const hvp_bus way = bus();
    EXPECT_EQ(hvp_open(&device, &way, scratch.data(), scratch.size()), HVP_OK);
    const hvp_solver_config config = driver_config(scene.settings.solver);
    EXPECT_EQ(hvp_configure(&device, &config), HVP_OK);
    const fixed::QuantisedMatrix& k = scene.computation.board().matrix();
    const hvp_matrix matrix{static_cast<std::uint32_t>(k.block_rows()),
                            static_cast<std::uint32_t>(k.column.size()), k.row_begin.data(),
                            k.column.data(), k.value.data()};
    EXPECT_EQ(hvp_load_matrix(&device, &matrix), HVP_OK);
  }
  std::vector<std::int32_t> expected() const {
    std::vector<std::int32_t> solution(b.size(), 0);
    fixed::ReferenceSolver(scene.settings.solver)
        .solve(scene.computation.board().matrix(), {b, solution});
    return solution;
  }

  hvp_device device{};
  std::vector<std::uint32_t> scratch = std::vector<std::uint32_t>(SmallScene::kUnknowns);
  std::vector<std::int32_t> b = test::words(SmallScene::kUnknowns, 200);
  std::vector<std::int32_t> u = std::vector<std::int32_t>(SmallScene::kUnknowns);
};

// The segments of b and U are this test's own memory, at addresses of the bus far from zero.
struct GuestMemory {
  static constexpr std::uint64_t kLow = 0x4000'0000;
  static constexpr std::uint64_t kHigh = 0x12'0000'0000;

  explicit GuestMemory(Host& host) {
    HostMemory& memory = *host.side->board()->memory();
    memory.map(kLow, Host::bytes(low));
    memory.map(kHigh, Host::bytes(high));
    to_board = {low.data() + 256, kLow + 1024, 1024};
    to_host = {high.data(), kHigh, 1024};
    dma.to_board = &to_board;
    dma.to_board_count = 1;
    dma.to_host = &to_host;
    dma.to_host_count = 1;
    dma.list = low.data();
    dma.list_address = kLow;
    dma.record = low.data() + 128;
    dma.record_address = kLow + 512;
  }
  std::vector<std::uint32_t> low = std::vector<std::uint32_t>(1024);
  std::vector<std::uint32_t> high = std::vector<std::uint32_t>(1024);
  hvp_segment to_board{};
  hvp_segment to_host{};
  hvp_dma dma{};
};

inline void with_dma(PlatformSettings& settings) {
  settings.transfer.method = Transfer::Method::dma;
}

}  // namespace hvp::vp::outside_host_test
