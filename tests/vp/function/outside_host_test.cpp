// A host that is this test itself, not a process of SystemC: it goes through the board as a kernel
// does, at the board's exact times.
#include "vp/function/outside_host.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "driver/hvp_driver.h"
#include "models/fixed/reference_solver.h"
#include "tests/vp/board_master.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/host/driver_config.h"

namespace hvp::vp::outside_host_test {
namespace {

using test::kUs;
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
    host->config().write(at, std::span(data).first(bytes));
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
    const fixed::QuantisedMatrix& k = scene.computation.quantised();
    const hvp_matrix matrix{static_cast<std::uint32_t>(k.block_rows()),
                            static_cast<std::uint32_t>(k.column.size()), k.row_begin.data(),
                            k.column.data(), k.value.data()};
    EXPECT_EQ(hvp_load_matrix(&device, &matrix), HVP_OK);
  }
  std::vector<std::int32_t> expected() const {
    std::vector<std::int32_t> solution(b.size(), 0);
    fixed::ReferenceSolver(scene.settings.solver)
        .solve(scene.computation.quantised(), {b, solution});
    return solution;
  }

  hvp_device device{};
  std::vector<std::uint32_t> scratch = std::vector<std::uint32_t>(SmallScene::kUnknowns);
  std::vector<std::int32_t> b = test::words(SmallScene::kUnknowns, 200);
  std::vector<std::int32_t> u = std::vector<std::int32_t>(SmallScene::kUnknowns);
};

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
  EXPECT_EQ(pair, (std::array<std::uint32_t, 2>{0x4856'5031, 0x0002'0001}));
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
  const auto& k = host.scene.computation.quantised();
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

void with_dma(PlatformSettings& settings) { settings.transfer.method = Transfer::Method::dma; }

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
