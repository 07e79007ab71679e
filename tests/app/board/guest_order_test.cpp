// A host that stands still at random, and one whose stores are late: a driver that is right stays
// right, one that is wrong is found out by one of a hundred seeds, and that seed repeats it.
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <iterator>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/board/hvp_board.h"
#include "tests/app/board/register_driver.h"
#include "tests/vp/child_output.h"

namespace hvp::test::registers {
namespace {

constexpr int kJobs = 4;
constexpr std::int64_t kSeeds = 100;  // as the drivers below are to be found within

// Which of the words of U are there after each job, and when; "lost" where no record came. The
// findings, if the driver is watched. One process each.
std::string run(std::int64_t seed, const std::vector<std::string>& keys, bool check,
                const std::function<void(Driver&)>& ring) {
  return output_of_child([&](std::string& text) {
    std::vector<std::string> all = {"transfer.method=dma", "transfer.notification=msi",
                                    fmt::format("seed={}", seed)};
    all.insert(all.end(), keys.begin(), keys.end());
    std::vector<const char*> words;
    std::ranges::transform(all, std::back_inserter(words), &std::string::c_str);
    Driver d(words, check);
    d.load();
    for (int job = 0; job < kJobs; ++job) {
      d.describe();
      d.tell_list();
      std::fill_n(d.page(1), 2, 0xdeadbeef);
      ring(d);
      const bool came = d.await_record();
      text += came ? fmt::format("{:x} {:x}", d.page(1)[0], d.page(1)[1]) : "lost";
      text += fmt::format(" at {}\n", hvp_board_now_ps(d.board));
      d.acknowledge();
      if (!came) d.write(kControl, field::kControlReset.mask());
      if (!came) break;
    }
    for (const hvp_board_finding& finding : d.findings()) {
      text += fmt::format("{}: {}\n", finding.rule, finding.what);
    }
  });
}

// The driver without a mistake.
void ring_in_order(Driver& d) { d.ring(); }

void ring_without_barrier(Driver& d) {
  d.page(3)[0] = 0;
  d.start_list();
}

void ring_before_the_record_is_cleared(Driver& d) {
  d.barrier();
  d.start_list();
  d.page(3)[0] = 0;
  d.barrier();
}

// The words alone, without their times and without findings.
std::string words_of(const std::string& text) {
  std::istringstream lines(text);
  std::string words;
  for (std::string line; std::getline(lines, line);) {
    if (const std::size_t at = line.find(" at "); line.find(": ") == std::string::npos) {
      words += line.substr(0, at) + "\n";
    }
  }
  return words;
}

// As of a host that goes on at once and whose stores are in order.
bool is_right(const std::string& text) {
  static const std::string kRight = words_of(run(1, {}, false, ring_in_order));
  return kRight.find("lost") == std::string::npos && words_of(text) == kRight;
}

const std::vector<std::string> kRandom = {"guest.schedule=random"};
const std::vector<std::string> kWeak = {"guest.memory_order=weak"};

struct Found {
  std::int64_t seed = -1;  // the first at which it goes wrong; −1: at none
  std::string text;
};
Found first_wrong(const std::vector<std::string>& keys, const std::function<void(Driver&)>& ring) {
  for (std::int64_t seed = 0; seed < kSeeds; ++seed) {
    std::string text = run(seed, keys, false, ring);
    if (!is_right(text)) return {seed, std::move(text)};
  }
  return {};
}

TEST(GuestOrder, ARightDriverStaysRight) {
  for (std::int64_t seed = 0; seed < 20; ++seed) {
    for (const auto& keys : {kRandom, kWeak}) {
      const std::string text = run(seed, keys, true, ring_in_order);
      EXPECT_TRUE(is_right(text)) << keys.front() << ", seed " << seed << ":\n" << text;
      EXPECT_EQ(text.find(": "), std::string::npos) << text;
    }
  }
}

TEST(GuestOrder, AWrongDriverWorksWithoutThem) {
  EXPECT_TRUE(is_right(run(1, {}, false, ring_without_barrier)));
  EXPECT_TRUE(is_right(run(1, {}, false, ring_before_the_record_is_cleared)));
}

TEST(GuestOrder, AMissingBarrierIsFoundAndRepeated) {
  const Found found = first_wrong(kWeak, ring_without_barrier);
  ASSERT_GE(found.seed, 0);
  EXPECT_EQ(run(found.seed, kWeak, false, ring_without_barrier), found.text);
}

// By its name, whatever the seed draws.
TEST(GuestOrder, AMissingBarrierIsNamedAtEverySeed) {
  for (std::int64_t seed = 0; seed < 5; ++seed) {
    const std::string text = run(seed, kWeak, true, ring_without_barrier);
    EXPECT_NE(
        text.find("missing-barrier: the board read 64 bytes at 0x10002000, which the host has "
                  "stored to without a barrier behind it"),
        std::string::npos)
        << text;
  }
}

TEST(GuestOrder, ARaceIsFoundAndRepeated) {
  const Found found = first_wrong(kRandom, ring_before_the_record_is_cleared);
  ASSERT_GE(found.seed, 0);
  EXPECT_NE(found.text.find("lost"), std::string::npos) << found.text;
  EXPECT_EQ(run(found.seed, kRandom, false, ring_before_the_record_is_cleared), found.text);
}

TEST(GuestOrder, SeedsDiffer) {
  EXPECT_NE(run(1, kRandom, false, ring_in_order), run(2, kRandom, false, ring_in_order));
}

}  // namespace
}  // namespace hvp::test::registers
