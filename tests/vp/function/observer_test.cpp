// What an observer of the host and of its memory sees of a job by DMA, and in which order.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/function/outside_host_rig.h"

namespace hvp::vp::outside_host_test {
namespace {

class Seen : public OutsideHost::Observer, public MemoryObserver {
 public:
  void asked(const OutsideHost::Access& /*access*/) override {
    ++asks;
    EXPECT_GE(asks, ends);
  }
  void ended(const OutsideHost::Access& access) override {
    ++ends;
    if (access.command == Command::read && access.data.size() == 4) {
      last_word = {access.data.begin(), access.data.end()};
    }
  }
  void message(const ConfigSpace::Message& /*message*/) override { events.emplace_back("message"); }
  void line(bool up) override { events.emplace_back(up ? "up" : "down"); }
  void mapped(std::uint64_t /*address*/, std::uint64_t bytes, bool writable) override {
    EXPECT_EQ(bytes, 4096U);
    EXPECT_TRUE(writable);
    events.emplace_back("map");
  }
  void unmapped(std::uint64_t /*address*/, std::uint64_t /*bytes*/) override {
    events.emplace_back("unmap");
  }
  void to_be_moved(bool read, std::uint64_t /*address*/, std::size_t /*bytes*/) override {
    if (read) events.emplace_back("to be read");
  }
  void moved(bool read, std::uint64_t /*address*/, std::span<const std::uint8_t> /*data*/,
             bool answered) override {
    events.push_back(std::string(read ? "read" : "write") + (answered ? "" : " refused"));
  }

  int asks = 0;
  int ends = 0;
  std::vector<std::uint8_t> last_word;
  std::vector<std::string> events;
};

TEST(OutsideHostObserver, SeesAJobByDmaAndItsLine) {
  Loaded host(with_dma);
  Seen seen;
  host.host->observe(seen);
  HostMemory& memory = *host.side->board()->memory();
  memory.observe(seen);
  GuestMemory guest(host);
  ASSERT_EQ(hvp_use_dma(&host.device, &guest.dma), HVP_OK);
  ASSERT_EQ(hvp_solve(&host.device, host.b.data(), host.u.data(), host.u.size(), 1'000'000),
            HVP_OK);
  EXPECT_EQ(host.u, host.expected());
  EXPECT_TRUE(memory.unmap(GuestMemory::kHigh, 4096));
  EXPECT_FALSE(memory.unmap(GuestMemory::kLow, 8));  // changes nothing
  EXPECT_EQ(seen.events,
            (std::vector<std::string>{"map", "map", "to be read", "read", "to be read", "read",
                                      "write", "write", "up", "down", "unmap"}));
  EXPECT_EQ(seen.asks, seen.ends);
  EXPECT_EQ(host.read(Register::id), 0x4856'5031U);
  EXPECT_EQ(seen.last_word, (std::vector<std::uint8_t>{0x31, 0x50, 0x56, 0x48}));
}

// The words that the observer puts into memory before the board reads are those that it gets.
TEST(OutsideHostObserver, MayStillChangeWhatIsToBeRead) {
  class Changes : public Seen {
   public:
    explicit Changes(std::span<std::uint32_t> b) : b_(b) {}
    void to_be_moved(bool read, std::uint64_t address, std::size_t /*bytes*/) override {
      if (read && address == GuestMemory::kLow + 1024) std::ranges::fill(b_, 0U);
    }

   private:
    std::span<std::uint32_t> b_;
  };
  Loaded host(with_dma);
  GuestMemory guest(host);
  Changes changes(std::span(guest.low).subspan(256, 256));
  host.side->board()->memory()->observe(changes);
  ASSERT_EQ(hvp_use_dma(&host.device, &guest.dma), HVP_OK);
  ASSERT_EQ(hvp_solve(&host.device, host.b.data(), host.u.data(), host.u.size(), 1'000'000),
            HVP_OK);
  EXPECT_EQ(host.u, std::vector<std::int32_t>(host.u.size(), 0));
}

}  // namespace
}  // namespace hvp::vp::outside_host_test
