// The interrupt's top half beside the thread: wherever the handler comes between the thread's
// accesses, the line is down when it returns and no end is lost.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"

namespace hvp::test::irq_test {
namespace {

using vp::Register;

// A processor with an interrupt controller between the driver and the board. At each opportunity,
// before and after every access and every lock of the thread's, the schedule says whether the
// handler runs; while the lock is held it does not, as under spin_lock_irqsave. A sleeping thread
// is interrupted at once.
class Processor {
 public:
  Processor(ScriptedBoard& board, hvp_device& device)
      : board_(board), device_(device), wrapped_(board.bus()) {}

  hvp_bus bus() {
    hvp_bus bus = wrapped_;
    bus.pause = nullptr;
    bus.context = this;
    bus.read32 = [](void* context, std::uint32_t offset) {
      std::uint32_t value = 0;
      of(context).access([&](const hvp_bus& to) { value = to.read32(to.context, offset); });
      return value;
    };
    bus.write32 = [](void* context, std::uint32_t offset, std::uint32_t value) {
      of(context).access([&](const hvp_bus& to) { to.write32(to.context, offset, value); });
    };
    bus.read_block = [](void* context, std::uint32_t offset, std::uint32_t* words, std::size_t n) {
      of(context).access([&](const hvp_bus& to) { to.read_block(to.context, offset, words, n); });
    };
    bus.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                         std::size_t n) {
      of(context).access([&](const hvp_bus& to) { to.write_block(to.context, offset, words, n); });
    };
    bus.now_ns = [](void* context) { return of(context).board_.now_ns(); };
    bus.wait_interrupt = [](void* context, std::uint64_t timeout_ns) {
      return of(context).sleep(timeout_ns);
    };
    bus.lock = [](void* context) { of(context).lock(); };
    bus.unlock = [](void* context) { of(context).unlock(); };
    return bus;
  }

  bool line_is_up() const {
    return (board_.bank().get(Register::interrupt_status) &
            board_.bank().get(Register::interrupt_enable)) != 0;
  }

  // What the handler is called for whatever the line is: a neighbour's interrupt too.
  int handle() {
    const bool up = line_is_up();
    const std::uint32_t enabled = board_.bank().get(Register::interrupt_enable);
    in_handler_ = true;
    accesses_ = 0;
    const int outcome = hvp_irq(&device_, true);
    in_handler_ = false;
    // Who returns with the line up is called again, before the thread can do anything about it.
    EXPECT_TRUE(!up || outcome == HVP_IRQ_MINE);
    if (outcome == HVP_IRQ_MINE) {
      // The board may have ended at the handler's own read.
      EXPECT_NE(board_.bank().get(Register::interrupt_status), 0U);
      EXPECT_FALSE(line_is_up());
    } else {
      EXPECT_LE(accesses_, 1);
      EXPECT_EQ(board_.bank().get(Register::interrupt_enable), enabled);
    }
    woken_ = woken_ || outcome == HVP_IRQ_MINE;
    return outcome;
  }

  // The handler's wake-up, as a poll() would look for it; the board gets on meanwhile.
  bool woken_within(std::uint64_t timeout_ns) { return sleep(timeout_ns) == HVP_INTERRUPT; }

  int accesses() const { return accesses_; }

  // Bit n: the handler runs at opportunity n, where it runs at all; used up from the lowest.
  std::uint32_t schedule = 0;
  bool neighbour = false;  // runs there whether the line is up or not

 private:
  static Processor& of(void* context) { return *static_cast<Processor*>(context); }

  void opportunity() {
    if (in_handler_ || held_) return;
    const bool chosen = (schedule & 1U) != 0U;
    schedule >>= 1U;
    if (chosen && (neighbour || line_is_up())) (void)handle();
  }

  template <typename Access>
  void access(const Access& access) {
    ++accesses_;
    EXPECT_TRUE(held_ || !in_handler_);
    opportunity();
    access(wrapped_);
    opportunity();
  }

  void lock() {
    opportunity();
    ASSERT_FALSE(held_);
    held_ = true;
  }
  void unlock() {
    ASSERT_TRUE(held_);
    held_ = false;
    opportunity();
  }

  int sleep(std::uint64_t timeout_ns) {
    EXPECT_FALSE(held_);
    if (line_is_up()) (void)handle();
    if (!woken_) {
      (void)wrapped_.wait_interrupt(wrapped_.context, timeout_ns);
      if (line_is_up()) (void)handle();
    }
    return std::exchange(woken_, false) ? HVP_INTERRUPT : HVP_INTERRUPT_TIMED_OUT;
  }

  ScriptedBoard& board_;
  hvp_device& device_;
  hvp_bus wrapped_;
  bool held_ = false;
  bool in_handler_ = false;
  bool woken_ = false;
  int accesses_ = 0;
};

class DriverWithAHandler : public DriverOnBoard {
 protected:
  // Words of memory by DMA.
  static constexpr std::size_t kList = 0, kRecord = 64, kB = 128, kU = 256;

  void load_on(const hvp_bus& bus) {
    const hvp_solver_config config = thesis_config();
    const hvp_matrix view = matrix.view();
    ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  }
  void use_dma() {
    to_board = {board.memory(kB), ScriptedBoard::address(kB), 64};
    to_host = {board.memory(kU), ScriptedBoard::address(kU), 64};
    hvp_dma dma{};
    dma.to_board = &to_board;
    dma.to_host = &to_host;
    dma.to_board_count = dma.to_host_count = 1;
    dma.list = board.memory(kList);
    dma.list_address = ScriptedBoard::address(kList);
    dma.record = board.memory(kRecord);
    dma.record_address = ScriptedBoard::address(kRecord);
    ASSERT_EQ(hvp_use_dma(&device, &dma), HVP_OK);
  }
  hvp_status solve() { return hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs); }

  // A frame for every schedule of the first opportunities, and for every access at which a job may
  // end; what a frame leaves is what the next one begins with.
  void interleave() {
    constexpr std::uint32_t kSchedules = 1U << 11U;
    for (const bool neighbour : {false, true}) {
      processor.neighbour = neighbour;
      for (std::uint64_t end = 0; end <= 8 * ScriptedBoard::kAccessNs;
           end += ScriptedBoard::kAccessNs) {
        board.job_ns = end;
        for (std::uint32_t schedule = 0; schedule < kSchedules; ++schedule) {
          processor.schedule = schedule;
          ASSERT_EQ(solve(), HVP_OK) << "ends after " << end << " ns, schedule " << schedule;
          ASSERT_EQ(hvp_statistics_of(&device).lost_interrupts, 0U)
              << "ends after " << end << " ns, schedule " << schedule;
          board.take_log();
        }
        if (HasFailure()) return;
      }
    }
  }

  Processor processor{board, device};
  hvp_segment to_board{};
  hvp_segment to_host{};
};

TEST_F(DriverWithAHandler, NoInterruptIsLostWhereverTheHandlerComes) {
  load_on(processor.bus());
  interleave();
  EXPECT_TRUE(board.refused().empty());
}

TEST_F(DriverWithAHandler, NorByDma) {
  load_on(processor.bus());
  use_dma();
  interleave();
}

// A line as a PCI Express link has it: its messages follow the board's writes, and the driver
// leaves `done` up for the next list to clear.
TEST_F(DriverWithAHandler, NorWhereTheEndIsLeftUp) {
  hvp_bus bus = processor.bus();
  bus.interrupts_after_writes = true;
  load_on(bus);
  use_dma();
  interleave();
}

// Who polls hears of an end from the handler alone, and waits when it is there.
TEST_F(DriverWithAHandler, AStartIsEnoughToHearOfTheEnd) {
  for (const bool after_writes : {false, true}) {
    hvp_bus bus = processor.bus();
    bus.interrupts_after_writes = after_writes;
    load_on(bus);
    use_dma();
    for (std::uint32_t schedule = 0; schedule < 64; ++schedule) {
      processor.schedule = schedule;
      ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
      ASSERT_EQ(hvp_start(&device), HVP_OK);
      hvp_status status = HVP_ERROR_TIMEOUT;
      // An early wake-up is possible, a missing one is not.
      for (int looks = 0; looks < 3 && status == HVP_ERROR_TIMEOUT; ++looks) {
        ASSERT_TRUE(processor.woken_within(kTimeoutNs)) << schedule;
        status = hvp_wait(&device, 0);
      }
      ASSERT_EQ(status, HVP_OK) << schedule;
    }
  }
}

// An acknowledgement that got lost raises the line in the next job: masked, looked at, unmasked.
TEST_F(DriverWithAHandler, EarlyWakeUpsAreWaitedOut) {
  load_on(processor.bus());
  for (std::uint32_t schedule = 0; schedule < 256; ++schedule) {
    processor.schedule = schedule;
    board.bank().set(vp::field::kInterruptStatusDone, 1);
    board.bank().set(vp::field::kStatusDone, 1);
    ASSERT_EQ(solve(), HVP_OK) << schedule;
    ASSERT_EQ(hvp_statistics_of(&device).lost_interrupts, 0U) << schedule;
    ASSERT_EQ(hvp_statistics_of(&device).lost_acknowledgements, schedule + 1) << schedule;
  }
}

TEST_F(DriverWithAHandler, ErrorsRaiseTheLineToo) {
  load_on(processor.bus());
  for (std::uint32_t schedule = 0; schedule < 256; ++schedule) {
    processor.schedule = schedule;
    board.end_with = vp::ErrorCode::internal_fault;
    ASSERT_EQ(solve(), HVP_ERROR_BOARD) << schedule;
    board.end_with = vp::ErrorCode::none;
    ASSERT_EQ(solve(), HVP_OK) << schedule;
  }
  EXPECT_EQ(hvp_statistics_of(&device).lost_interrupts, 0U);
}

TEST_F(DriverWithAHandler, AResetAndALoadBesideTheHandler) {
  for (std::uint32_t schedule = 0; schedule < 1024; ++schedule) {
    load_on(processor.bus());
    ASSERT_EQ(hvp_start(&device), HVP_OK);
    board.job_ns = schedule % 8 * ScriptedBoard::kAccessNs;
    processor.schedule = schedule;
    ASSERT_EQ(hvp_reset(&device), HVP_OK);
    EXPECT_EQ(board.bank().get(Register::interrupt_enable), 3U);
    const hvp_solver_config config = thesis_config();
    const hvp_matrix view = matrix.view();
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
    ASSERT_EQ(solve(), HVP_OK);
    ASSERT_EQ(hvp_statistics_of(&device).lost_interrupts, 0U);
    board.take_log();
  }
}

TEST_F(DriverWithAHandler, ABoardThatIsNotOpenIsNotTouched) {
  EXPECT_EQ(hvp_irq(nullptr, true), HVP_IRQ_NONE);
  EXPECT_EQ(hvp_irq(&device, true), HVP_IRQ_NONE);
  load_on(processor.bus());
  ASSERT_EQ(hvp_close(&device), HVP_OK);
  board.bank().set(vp::field::kInterruptStatusDone, 1);
  board.take_log();
  EXPECT_EQ(processor.handle(), HVP_IRQ_NONE);
  EXPECT_TRUE(board.take_log().empty());
}

// Reads of ones, as of a board that was pulled out, are no interrupt of its own.
TEST_F(DriverWithAHandler, ABoardThatIsGoneHasNotInterrupted) {
  load_on(processor.bus());
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  board.dead = true;
  EXPECT_EQ(processor.handle(), HVP_IRQ_NONE);
  EXPECT_EQ(processor.accesses(), 1);
}

TEST_F(DriverWithAHandler, AMessageIsTakenWithoutAnAccess) {
  load_on(processor.bus());
  board.take_log();
  EXPECT_EQ(hvp_irq(&device, false), HVP_IRQ_MINE);
  EXPECT_TRUE(board.take_log().empty());
}

// What the handler costs on the bus, and the thread's one write for it.
TEST_F(DriverWithAHandler, ALineIsMaskedOnceAndUnmaskedByTheNextStart) {
  using Log = std::vector<std::string>;
  load_on(processor.bus());
  board.job_ns = 500'000;
  ASSERT_EQ(solve(), HVP_OK);
  board.take_log();
  ASSERT_EQ(solve(), HVP_OK);
  EXPECT_EQ(board.take_log(),
            (Log{"write B[+0x0] x8", "write CONTROL 0x1", "write INTERRUPT_ENABLE 0x3", "wait",
                 "read INTERRUPT_STATUS", "write INTERRUPT_ENABLE 0x0", "read STATUS",
                 "write INTERRUPT_STATUS 0x1", "read U[+0x0] x8"}));
}

TEST_F(DriverWithAHandler, HalfALockIsRefused) {
  hvp_bus bus = processor.bus();
  bus.unlock = nullptr;
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_ARGUMENT);
  bus = processor.bus();
  bus.lock = nullptr;
  EXPECT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace hvp::test::irq_test
