#include "models/link/pci_arbiter.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/allocation_count.h"

namespace hvp::link::pci_arbiter_test {
namespace {

constexpr std::int64_t kClock = 30'000;  // ps at 33 MHz

PciProtocol protocol(int latency_timer, PciArbitration arbitration = PciArbitration::round_robin) {
  PciProtocol p;
  p.latency_timer_clocks = latency_timer;
  p.arbitration = arbitration;
  return p;
}

Pci long_bursts() {
  Pci pci;
  pci.burst_bytes = 4096;
  return pci;
}

TEST(PciArbiter, WithoutContentionItTakesTheFormulasTime) {
  for (const PciKind kind :
       {PciKind::pci_32_33, PciKind::pci_32_66, PciKind::pci_64_66, PciKind::pci_x_133}) {
    for (const int delayed : {0, 7, 23, 200}) {
      for (const int wait_states : {0, 1, 3}) {
        Pci pci;
        pci.kind = kind;
        PciProtocol p;
        p.delayed_read_clocks = delayed;
        p.wait_states = wait_states;
        PciArbiter bus(pci, p, 2);
        std::int64_t now = 100 * pci.clock_period_ps();
        for (const std::int64_t bytes : {4, 8, 64, 68, 256, 1500, 3000, 24'000}) {
          for (const Direction direction : {Direction::write, Direction::read}) {
            bus.request(0, direction, bytes, now);
            const std::int64_t end = bus.forecast(0);
            EXPECT_EQ(end - now, bus.clocks().alone_ps(direction, bytes)) << bytes;
            bus.advance(end - 1);
            EXPECT_FALSE(bus.done(0));
            bus.advance(end);
            EXPECT_TRUE(bus.done(0));
            EXPECT_EQ(bus.completed_ps(0), end);
            now = end;
          }
        }
      }
    }
  }
}

TEST(PciArbiter, RequestBetweenTwoEdgesIsSeenAtTheNextOne) {
  PciArbiter bus({}, {}, 1);
  bus.request(0, Direction::write, 4, 10 * kClock + 1);
  EXPECT_EQ(bus.forecast(0), (11 + 5) * kClock);
}

// Master 0 starts at clock 1, after one clock of arbitration: address 1, wait 2, data from 3 on.
// Master 1 asks at clock 10 and its arbitration takes one clock: GNT# is gone at edge 11.
TEST(PciArbiter, ExpiredTimerGivesTheBusUpAfterTheDataPhaseUnderWay) {
  PciArbiter bus(long_bursts(), protocol(8), 2);
  bus.request(0, Direction::write, 400, 0);  // 100 words
  bus.request(1, Direction::write, 4, 10 * kClock);
  // The timer ran out at edge 9. The phase that ends at edge 12 is the last: words 3 to 11, nine
  // of them; turnaround at 12. Master 1: address 13, wait 14, data 15, turnaround until 17.
  EXPECT_EQ(bus.forecast(1), 17 * kClock);
  // Master 0 asked again at 13 and goes on at 17: two clocks, 91 words, turnaround.
  EXPECT_EQ(bus.forecast(0), (17 + 2 + 91 + 1) * kClock);
  bus.advance(1'000 * kClock);
  EXPECT_EQ(bus.statistics(0).preemptions, 1);
  EXPECT_EQ(bus.statistics(0).tenures, 2);
}

TEST(PciArbiter, RunningTimerKeepsTheBus) {
  PciArbiter bus(long_bursts(), protocol(64), 2);
  bus.request(0, Direction::write, 400, 0);
  bus.request(1, Direction::write, 4, 10 * kClock);
  // Address at clock 1, so that the timer runs out at edge 65; the phase that ends at 66 is the
  // last; turnaround; then 2 + 1 + 1 clocks of master 1.
  EXPECT_EQ(bus.forecast(1), (66 + 1 + 4) * kClock);
}

TEST(PciArbiter, ShortBurstsEndBeforeAnyTimerAndMastersAlternate) {
  PciArbiter bus({}, protocol(64), 2);
  bus.request(0, Direction::write, 128, 0);
  bus.request(1, Direction::write, 128, 0);
  // Bursts of 2 + 16 + 1 clocks back to back, arbitration hidden but for the first.
  EXPECT_EQ(bus.forecast(0), (1 + 3 * 19) * kClock);
  EXPECT_EQ(bus.forecast(1), (1 + 4 * 19) * kClock);
}

TEST(PciArbiter, FixedPriorityServesTheLowerNumberFirst) {
  for (const bool low_calls_first : {true, false}) {
    PciArbiter bus({}, protocol(64, PciArbitration::fixed_priority), 3);
    bus.request(1, Direction::write, 64, 0);
    bus.request(low_calls_first ? 0 : 2, Direction::write, 64, 5 * kClock);
    bus.request(low_calls_first ? 2 : 0, Direction::write, 64, 5 * kClock);
    EXPECT_EQ(bus.forecast(0), (1 + 2 * 19) * kClock);
    EXPECT_EQ(bus.forecast(2), (1 + 3 * 19) * kClock);
  }
}

TEST(PciArbiter, SimultaneousRequestsDoNotDependOnTheOrderOfTheCalls) {
  for (const PciArbitration policy :
       {PciArbitration::round_robin, PciArbitration::fixed_priority}) {
    PciArbiter up({}, protocol(16, policy), 3);
    PciArbiter down({}, protocol(16, policy), 3);
    for (int i = 0; i < 3; ++i) {
      up.request(i, Direction::read, 200 + 100 * i, 7 * kClock);
      down.request(2 - i, Direction::read, 200 + 100 * (2 - i), 7 * kClock);
    }
    for (int i = 0; i < 3; ++i) EXPECT_EQ(up.forecast(i), down.forecast(i));
  }
}

TEST(PciArbiter, RetriesLeaveTheBusToOthers) {
  PciProtocol p;
  p.delayed_read_clocks = 100;
  PciArbiter bus({}, p, 2);
  bus.request(0, Direction::read, 64, 0);
  bus.request(1, Direction::write, 64, 2 * kClock);
  // The first attempt (address 1, wait 2, turnaround 3) is over at 4: master 1 is served at once.
  EXPECT_EQ(bus.forecast(1), (4 + 19) * kClock);
  bus.advance(1'000 * kClock);
  EXPECT_GT(bus.statistics(0).retries, 10);
  EXPECT_EQ(bus.statistics(0).bytes, 64);
}

TEST(PciArbiter, PreemptedPciXBurstEndsAtADisconnectBoundary) {
  Pci pci = long_bursts();
  pci.kind = PciKind::pci_x_133;
  PciArbiter bus(pci, protocol(0), 2);
  bus.request(0, Direction::write, 1'024, 0);
  bus.request(1, Direction::write, 8, 5 * 7'500);
  // Address and attribute 0 and 1, wait 2, then 16 data phases of 8 bytes: the boundary is at 19,
  // the bus is free at 20. Master 1 needs 3 + 1 + 1 clocks.
  EXPECT_EQ(bus.forecast(1), (20 + 5) * 7'500);
}

// The same rules, written down a second time as a machine that takes one step a clock.
class EveryClock {
 public:
  EveryClock(const PciClocks& clocks, int masters)
      : clocks_(clocks), masters_(static_cast<std::size_t>(masters)) {}

  struct Master {
    std::int64_t start = 0;
    std::int64_t words = 0;
    Direction direction = Direction::write;
    std::int64_t released = -1;
    std::int64_t asserted = -1;
    std::int64_t in_burst = 0;
  };
  Master& master(int i) { return masters_[static_cast<std::size_t>(i)]; }

  void run() {
    for (Master& m : masters_) m.asserted = m.start;
    for (std::int64_t clock = 0; clock < 100'000; ++clock) step(clock);
  }

 private:
  bool asks(const Master& m, std::int64_t clock) const {
    return m.words > 0 && m.asserted + clocks_.arbitration() <= clock;
  }
  bool others_ask(std::int64_t clock) const {
    for (std::size_t i = 0; i < masters_.size(); ++i) {
      if (static_cast<int>(i) != owner_ && asks(masters_[i], clock)) return true;
    }
    return false;
  }
  void step(std::int64_t clock) {
    if (idle_ > 0) {
      --idle_;
      return;
    }
    if (owner_ < 0) {
      const int n = static_cast<int>(masters_.size());
      for (int i = 1; i <= n && owner_ < 0; ++i) {
        if (asks(master((last_ + i) % n), clock)) owner_ = (last_ + i) % n;
      }
      if (owner_ < 0) return;
      last_ = owner_;
      timer_ = clocks_.protocol().latency_timer_clocks;
      before_data_ = clocks_.address() + clocks_.first_wait(master(owner_).direction);
      phase_ = 0;
      final_ = false;
    }
    // The edge at the beginning of this clock: GNT# and the timer are looked at.
    if (timer_ <= 0 && others_ask(clock)) final_ = true;
    --timer_;
    if (before_data_ > 0) {
      --before_data_;
      return;
    }
    if (++phase_ < clocks_.per_phase()) return;
    phase_ = 0;
    Master& m = master(owner_);
    --m.words;
    ++m.in_burst;
    const bool boundary = m.in_burst == clocks_.burst_phases();
    if (boundary) m.in_burst = 0;
    if (m.words > 0 && !boundary && !final_) return;
    m.asserted = clock + 1 + clocks_.turnaround();
    if (m.words == 0) m.released = m.asserted;
    idle_ = clocks_.turnaround();
    owner_ = -1;
  }

  PciClocks clocks_;
  std::vector<Master> masters_;
  int owner_ = -1;
  int last_ = -1;
  std::int64_t idle_ = 0;
  std::int64_t timer_ = 0;
  std::int64_t before_data_ = 0;
  int phase_ = 0;
  bool final_ = false;
};

TEST(PciArbiter, AgreesWithAMachineThatTakesEveryClock) {
  std::uint32_t random = 12345;
  const auto draw = [&random](std::uint32_t below) {
    random = random * 1664525U + 1013904223U;
    return static_cast<std::int64_t>((random >> 8U) % below);
  };
  for (int round = 0; round < 60; ++round) {
    Pci pci;
    pci.burst_bytes = static_cast<int>(4 << draw(8));
    pci.overhead_clocks = static_cast<int>(2 + draw(6));
    PciProtocol p;
    p.latency_timer_clocks = static_cast<int>(draw(40));
    p.wait_states = static_cast<int>(draw(3));
    PciArbiter bus(pci, p, 3);
    EveryClock reference(bus.clocks(), 3);
    std::int64_t start = 0;
    for (int i = 0; i < 3; ++i) {
      const std::int64_t words = 1 + draw(300);
      const Direction direction = draw(2) == 0 ? Direction::write : Direction::read;
      reference.master(i) = {start, words, direction};
      bus.request(i, direction, 4 * words, start * kClock);
      start += draw(150);
    }
    reference.run();
    bus.advance(100'000 * kClock);
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(bus.done(i));
      EXPECT_EQ(bus.completed_ps(i), reference.master(i).released * kClock)
          << "round " << round << ", master " << i;
    }
  }
}

// What was owned, from address phase to turnaround.
class Owned : public PciArbiter::Observer {
 public:
  void owned(int master, std::int64_t start_ps, std::int64_t end_ps) override {
    tenures_.push_back({master, start_ps, end_ps});
  }
  std::int64_t until(std::int64_t time) const { return until(time, 0) + until(time, 1); }
  std::int64_t until(std::int64_t time, int master) const {
    std::int64_t sum = 0;
    for (const auto& t : tenures_) {
      if (t.master == master) sum += std::clamp<std::int64_t>(time - t.start, 0, t.end - t.start);
    }
    return sum;
  }

  int last() const { return tenures_.back().master; }

 private:
  struct Tenure {
    int master;
    std::int64_t start;
    std::int64_t end;
  };
  std::vector<Tenure> tenures_;
};

TEST(PciArbiter, WhatIsTakenByAnInstantDoesNotWaitForTheTenuresEnd) {
  const auto ask = [](PciArbiter& bus) {
    bus.request(0, Direction::read, 3'000, 0);
    bus.request(1, Direction::write, 3'000, 1'234'567);
  };
  PciArbiter bus({}, protocol(16), 2);
  PciArbiter followed({}, protocol(16), 2);
  Owned owned;
  followed.report_to(owned);
  ask(bus);
  ask(followed);
  followed.advance(100'000'000);
  std::int64_t last = 0;
  for (std::int64_t t = 1'234'567; t < 100'000'000; t += 7'777) {
    const std::int64_t taken = bus.taken_ps(t);
    ASSERT_EQ(taken, owned.until(t)) << "at " << t << " ps";
    for (const int master : {0, 1}) {
      ASSERT_EQ(bus.owned_ps(master, t), owned.until(t, master)) << master << " at " << t << " ps";
    }
    ASSERT_LE(taken - last, 7'777 + 1'234'567 * (last == 0 ? 1 : 0));
    last = taken;
  }
  // The master that did not own the bus last holds it: what it has of that sums with what it owned.
  const int holder = owned.last() == 0 ? 1 : 0;
  const std::int64_t before = followed.held_ps();
  followed.hold(holder, 100'600'000);
  const std::int64_t held = followed.held_ps() - before;
  for (const std::int64_t t : {100'000'000, 100'333'333, 200'000'000}) {
    EXPECT_EQ(followed.taken_ps(t), owned.until(t)) << t;
    EXPECT_EQ(followed.owned_ps(holder, t) + held, owned.until(t, holder)) << t;
    EXPECT_EQ(followed.owned_ps(1 - holder, t), owned.until(t, 1 - holder)) << t;
  }
}

TEST(PciArbiter, ForecastIsWhatHappensWhenNobodyElseAsks) {
  PciArbiter bus({}, protocol(16), 2);
  bus.request(0, Direction::read, 3'000, 0);
  bus.request(1, Direction::write, 3'000, 1'234'567);
  const std::int64_t first = bus.forecast(0);
  const std::int64_t second = bus.forecast(1);
  for (std::int64_t t = 0; t < 100'000'000; t += 777'777) bus.advance(t);
  EXPECT_EQ(bus.completed_ps(0), first);
  EXPECT_EQ(bus.completed_ps(1), second);
}

TEST(PciArbiter, NothingAllocates) {
  PciArbiter bus({}, {}, 2);
  const std::size_t before = test::allocation_count();
  bus.request(0, Direction::read, 3'000, 0);
  bus.request(1, Direction::write, 3'000, 0);
  EXPECT_LT(bus.next_completion(), kNever);
  bus.advance(bus.forecast(0));
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(PciArbiter, TooManyMastersAreRefused) {
  EXPECT_THROW(PciArbiter({}, {}, 0), InputError);
  EXPECT_THROW(PciArbiter({}, {}, 9), InputError);
}

}  // namespace
}  // namespace hvp::link::pci_arbiter_test
