// Drivers with a mistake, and drivers without one, through the C interface alone: which rule is
// named, with which word, and after how many accesses.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <ostream>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "app/board/hvp_board.h"
#include "tests/app/board/register_driver.h"
#include "vp/fpga/register_bank.h"
#include "vp/function/driver_finding.h"

namespace hvp::test::registers {
namespace {

std::vector<const char*> blocks() { return {}; }
std::vector<const char*> dma() { return {"transfer.method=dma", "transfer.notification=msi"}; }
std::vector<const char*> weak() {
  return {"transfer.method=dma", "transfer.notification=msi", "guest.memory_order=weak"};
}
std::vector<const char*> posted() {
  return {"transfer.method=dma", "transfer.notification=msi", "bus.pcie.generation=gen1",
          "bus.pcie.lanes=4"};
}

struct Mistake {
  const char* name;
  std::vector<const char*> (*keys)();
  const char* rule;
  // Part of what is said.
  const char* words;
  // Accesses between the mistake and its name.
  std::uint64_t later;
  std::function<void(Driver&)> drive;
};
void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.name; }

const std::vector<Mistake>& mistakes() {
  static const std::vector<Mistake> kAll = {
      {"no_register", blocks, "illegal-access", "write to 0x3c: no register there", 0,
       [](Driver& d) {
         d.mistake();
         d.write(0x3c, 1);
       }},
      {"b_while_busy", blocks, "access-while-busy", "write to B", 0,
       [](Driver& d) {
         d.load();
         d.give_b();
         d.start();
         d.mistake();
         d.give_b();
       }},
      {"start_twice", blocks, "access-while-busy", "write to CONTROL", 0,
       [](Driver& d) {
         d.load();
         d.give_b();
         d.start();
         d.mistake();
         d.start();
       }},
      {"error_unacknowledged", blocks, "command-ignored",
       "0x1 was written to CONTROL while error 4", 15,
       [](Driver& d) {
         d.mistake();
         d.start();  // without a matrix, and nothing acknowledges that error
         d.load();
         d.start();
       }},
      {"done_unacknowledged", blocks, "start-unacknowledged", "INTERRUPT_STATUS.done", 0,
       [](Driver& d) {
         d.load();
         d.give_b();
         d.start();
         d.wait();
         d.mistake();
         d.start();
       }},
      {"u_without_a_look", blocks, "early-result", "U[+0x0] was read while the job runs", 0,
       [](Driver& d) {
         d.load();
         d.give_b();
         d.start();
         d.mistake();
         d.read(kUMemory);
       }},
      {"u_after_a_pause", blocks, "early-result", "U[+0x0] was read before the host saw", 0,
       [](Driver& d) {
         d.load();
         d.give_b();
         d.start();
         hvp_board_run_until_ps(d.board, hvp_board_now_ps(d.board) + 1'000'000'000);
         d.mistake();
         d.read(kUMemory);
       }},
      {"missed_completion", blocks, "end-not-seen", "had not seen", 0,
       [](Driver& d) {
         d.load();
         d.give_b();
         d.start();
         hvp_board_run_until_ps(d.board, hvp_board_now_ps(d.board) + 1'000'000'000);
         d.acknowledge();
         d.mistake();
         d.start();
       }},
      {"format_after_load", blocks, "unloaded-matrix", "a write to FORMAT had unloaded", 3,
       [](Driver& d) {
         d.load();
         d.mistake();
         d.write(kFormat, 0x10101010);
         d.give_b();
         d.start();
       }},
      {"big_endian", blocks, "byte-order", "0x1000000 was written to NODES", 0,
       [](Driver& d) {
         d.mistake();
         d.write(kNodes, 0x0100'0000);
       }},
      {"list_after_reset", dma, "list-not-set", "DMA_LIST_LOW was not written", 0,
       [](Driver& d) {
         d.load();
         d.solve_by_dma();
         d.write(kControl, field::kControlReset.mask());
         d.load();
         d.mistake();
         d.ring();
       }},
      {"length_in_words", dma, "list-length", "move 4 bytes of B, which has 8", 0,
       [](Driver& d) {
         d.load();
         d.describe(4);
         d.tell_list();
         d.mistake();
         d.ring();
         d.await_record();
       }},
      {"record_behind_the_doorbell", dma, "owned-memory-touched", "the record at 0x10003000", 0,
       [](Driver& d) {
         d.load();
         d.describe();
         d.page(3)[0] = 1;
         d.tell_list();
         d.mistake();
         d.write(kControl, field::kControlRunList.mask());
         d.page(3)[0] = 0;
         d.await_record();
       }},
      {"b_behind_the_doorbell", posted, "owned-memory-touched", "b at 0x10000000", 0,
       [](Driver& d) {
         d.load();
         d.describe();
         d.tell_list();
         d.mistake();
         d.ring();
         d.page(0)[0] = 1;
         d.await_record();
       }},
      {"unmap_in_a_job", dma, "owned-memory-unmapped", "the record at 0x10003000", 0,
       [](Driver& d) {
         d.load();
         d.describe();
         d.tell_list();
         d.mistake();
         d.ring();
         hvp_board_unmap(d.board, kAddress, Driver::kPages * kPage);
       }},
      {"values_list_after_reset", dma, "list-not-set", "DMA_VALUES_LOW was not written", 0,
       [](Driver& d) {
         d.load();
         d.renew_by_dma();
         d.write(kControl, field::kControlReset.mask());
         d.load();
         d.mistake();
         d.fetch_values();
       }},
      {"values_behind_the_doorbell", posted, "owned-memory-touched", "the values at 0x10004000", 0,
       [](Driver& d) {
         d.load();
         d.describe_values();
         d.tell_values();
         d.mistake();
         d.fetch_values();
         d.page(4)[0] = 1;
         hvp_board_run_until_ps(d.board, hvp_board_now_ps(d.board) + 1'000'000'000);
       }},
      {"unmap_in_a_fetch", dma, "owned-memory-unmapped", "the list of values at 0x10005000", 0,
       [](Driver& d) {
         d.load();
         d.describe_values();
         d.tell_values();
         d.mistake();
         d.fetch_values();
         hvp_board_unmap(d.board, kAddress, Driver::kPages * kPage);
       }},
      {"no_barrier", weak, "missing-barrier", "the host has stored to without a barrier", 0,
       [](Driver& d) {
         d.load();
         d.describe();
         d.tell_list();
         d.mistake();
         d.start_list();
         d.await_record();
       }},
      {"no_bus_master", dma, "no-bus-master", "the function is no bus master", 0,
       [](Driver& d) {
         d.load();
         hvp_board_config_write(d.board, 4, 2, 2);
         d.describe();
         d.tell_list();
         d.mistake();
         d.ring();
         d.await_record();
       }},
      {"a_megabyte_off", dma, "stray-dma", "the board's read of 8 bytes at 0x10100000", 0,
       [](Driver& d) {
         d.load();
         d.describe(8, Driver::address(0) + 0x10'0000);
         d.tell_list();
         d.mistake();
         d.ring();
         d.await_record();
       }},
      {"interrupt_before_set_up", blocks, "interrupt-blocked", "never got it", 4,
       [](Driver& d) {
         d.load();
         hvp_board_config_write(d.board, 4, 6 | 0x400, 2);
         d.mistake();
         d.write(kInterruptEnable, 1);
         d.give_b();
         d.start();
         hvp_board_run_until_ps(d.board, hvp_board_now_ps(d.board) + 1'000'000'000);
         d.acknowledge();
       }},
      {"no_time_out", blocks, "endless-wait", "has no end", 1,
       [](Driver& d) {
         d.load();
         d.give_b();
         d.mistake();
         d.start();
         hvp_board_run_until_ps(d.board, hvp_board_now_ps(d.board) + 3 * 1000 * kSecond);
         d.read(kStatus);
       }},
  };
  return kAll;
}

std::string text_of(const std::string& page) {
  std::ifstream file(HVP_SCENARIOS "/../docs/" + page);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string replaced(std::string text, char old, char with) {
  std::ranges::replace(text, old, with);
  return text;
}

class DriverMistake : public testing::TestWithParam<Mistake> {};

TEST_P(DriverMistake, IsNamed) {
  const Mistake& mistake = GetParam();
  std::vector<const char*> keys = mistake.keys();
  const bool endless = std::string(mistake.rule) == "endless-wait";
  if (endless) keys.insert(keys.end(), {"fault[0].kind=stuck-busy", "fault[0].frame=0"});
  Driver driver(keys);
  mistake.drive(driver);
  const std::vector<hvp_board_finding> all = driver.findings();
  ASSERT_EQ(all.size(), 1U) << (all.empty() ? "nothing" : all[0].rule) << ", "
                            << (all.size() < 2 ? "nothing more" : all[1].rule);
  EXPECT_STREQ(all[0].rule, mistake.rule);
  EXPECT_NE(std::string(all[0].what).find(mistake.words), std::string::npos) << all[0].what;
  EXPECT_EQ(all[0].access - driver.at, mistake.later);
  // For docs/driver-bugs.md.
  RecordProperty("rule", all[0].rule);
  const std::string shown = replaced(mistake.name, '_', ' ');
  const std::string row =
      "| " + shown + " | `" + mistake.rule + "` | " + std::to_string(mistake.later) + " |";
  EXPECT_NE(text_of("driver-bugs.md").find(row), std::string::npos)
      << row << ": renew it: ./hvp tables driver-bugs > docs/driver-bugs.md";
  RecordProperty("later", static_cast<int>(all[0].access - driver.at));
}

INSTANTIATE_TEST_SUITE_P(All, DriverMistake, testing::ValuesIn(mistakes()),
                         [](const auto& one) { return std::string(one.param.name); });

// Of the program, not of the library below it. Not inlined, and no tail call.
[[gnu::noinline]] void write_where_no_register_is(Driver& d) {
  d.write(0x3c, 1);
  asm volatile("");
}
[[gnu::noinline]] void ring_a_megabyte_off(Driver& d) {
  d.ring();
  asm volatile("");
}

TEST(DriverRules, NameTheFunctionOfTheAccess) {
  Driver driver(blocks());
  driver.load();
  write_where_no_register_is(driver);
  const std::vector<hvp_board_finding> all = driver.findings();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NE(std::string(all[0].function).find("write_where_no_register_is"), std::string::npos)
      << all[0].function;
  EXPECT_EQ(std::string(all[0].function).find("hvp_board_write"), std::string::npos);
  EXPECT_NE(all[0].program_counter, 0U);
}

// The board's own transfer is of the doorbell that it obeys.
TEST(DriverRules, NameTheFunctionOfTheDoorbell) {
  Driver driver(dma());
  driver.load();
  driver.describe(8, Driver::address(0) + 0x10'0000);
  driver.tell_list();
  ring_a_megabyte_off(driver);
  driver.await_record();
  const std::vector<hvp_board_finding> all = driver.findings();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NE(std::string(all[0].function).find("ring_a_megabyte_off"), std::string::npos)
      << all[0].function;
}

// What looks like a mistake and is none.
TEST(DriverRules, BlameNobodyForALostAcknowledgement) {
  Driver driver({"fault[0].kind=master-abort", "fault[0].access=acknowledge", "fault[0].frame=0"});
  driver.load();
  driver.solve();
  driver.solve();
  for (const hvp_board_finding& one : driver.findings()) ADD_FAILURE() << one.what;
}

TEST(DriverRules, BlameNobodyForALongWaitThatEnds) {
  Driver driver({"fault[0].kind=stuck-busy", "fault[0].frame=0"});
  driver.load();
  driver.give_b();
  driver.start();
  hvp_board_run_until_ps(driver.board, hvp_board_now_ps(driver.board) + 3 * 1000 * kSecond);
  driver.write(kControl, field::kControlReset.mask());
  driver.load();
  driver.solve();
  for (const hvp_board_finding& one : driver.findings()) ADD_FAILURE() << one.what;
}

TEST(DriverRules, ABurstThatBeginsWithTheLookIsALook) {
  Driver driver(blocks());
  driver.load();
  driver.give_b();
  driver.start();
  std::array<std::uint32_t, 8> words{};
  do {
    hvp_board_read(driver.board, offset_of(Register::result_job), words.data(), sizeof words);
  } while (words[0] != 1);
  driver.acknowledge();
  for (const hvp_board_finding& one : driver.findings()) ADD_FAILURE() << one.what;
}

TEST(DriverRules, AnInterruptThatNobodyHearsOfIsAnEndlessWait) {
  Driver driver({"fault[0].kind=lost-interrupt", "fault[0].frame=0"});
  driver.load();
  driver.write(kInterruptEnable, 3);
  driver.give_b();
  driver.start();
  hvp_board_run_until_ps(driver.board, hvp_board_now_ps(driver.board) + 3 * 1000 * kSecond);
  const std::vector<hvp_board_finding> all = driver.findings();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_STREQ(all[0].rule, "endless-wait");
}

TEST(DriverRules, AListInTheOtherByteOrderIsNamed) {
  Driver driver(dma());
  driver.load();
  driver.describe();
  std::span<std::uint32_t> list(driver.page(2), 16);
  for (std::uint32_t& word : list) word = __builtin_bswap32(word);
  driver.tell_list();
  driver.ring();
  driver.await_record();
  const std::vector<hvp_board_finding> all = driver.findings();
  ASSERT_FALSE(all.empty());
  EXPECT_STREQ(all[0].rule, "byte-order");
}

TEST(DriverRules, ABoardThatMayNotMasterOwnsNoMemory) {
  Driver driver(dma());
  driver.load();
  driver.describe();
  driver.tell_list();
  driver.ring();
  hvp_board_config_write(driver.board, 4, 2, 2);
  hvp_board_unmap(driver.board, kAddress, Driver::kPages * kPage);
  for (const hvp_board_finding& one : driver.findings()) {
    EXPECT_STRNE(one.rule, "owned-memory-unmapped") << one.what;
  }
}

// What brings values is the board's until it has them, and then the host's again.
TEST(DriverRules, ValuesThatWereFetchedMayBeUnmapped) {
  Driver driver(posted());
  driver.load();
  driver.renew_by_dma();
  driver.page(4)[0] = 1;
  hvp_board_unmap(driver.board, kAddress, Driver::kPages * kPage);
  for (const hvp_board_finding& one : driver.findings()) ADD_FAILURE() << one.what;
}

// No record tells of its end: somebody has to look.
TEST(DriverRules, ValuesThatNobodyAsksForAreAnEndlessWait) {
  Driver driver(posted());
  driver.load();
  driver.describe_values();
  driver.tell_values();
  driver.fetch_values();
  hvp_board_run_until_ps(driver.board, hvp_board_now_ps(driver.board) + 3 * 1000 * kSecond);
  const std::vector<hvp_board_finding> all = driver.findings();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_STREQ(all[0].rule, "endless-wait");
  EXPECT_NE(std::string(all[0].what).find("values that were asked for"), std::string::npos)
      << all[0].what;
}

// The board refuses the command: it never owned the memory.
TEST(DriverRules, AFetchThatIsRefusedOwnsNoMemory) {
  Driver driver(posted());
  driver.describe_values();
  driver.tell_values();
  driver.fetch_values();  // without a pattern
  driver.read(kStatus);
  hvp_board_unmap(driver.board, kAddress, Driver::kPages * kPage);
  for (const hvp_board_finding& one : driver.findings()) ADD_FAILURE() << one.what;
}

// The board's own error says what is wrong with such a list.
TEST(DriverRules, AListThatFailedHasNoLength) {
  Driver driver(dma());
  driver.load();
  driver.describe(3);
  driver.tell_list();
  driver.ring();
  ASSERT_TRUE(driver.await_record());
  for (const hvp_board_finding& one : driver.findings()) ADD_FAILURE() << one.what;
}

class OtherByteOrder : public testing::TestWithParam<std::pair<std::uint32_t, std::uint32_t>> {};

TEST_P(OtherByteOrder, IsNamed) {
  Driver driver(blocks());
  driver.write(GetParam().first, GetParam().second);
  EXPECT_TRUE(driver.findings().empty());
  driver.write(GetParam().first, __builtin_bswap32(GetParam().second));
  ASSERT_FALSE(driver.findings().empty());
  EXPECT_STREQ(driver.findings()[0].rule, "byte-order");
}

INSTANTIATE_TEST_SUITE_P(All, OtherByteOrder,
                         testing::Values(std::pair{kNodes, 1U}, std::pair{kBlocks, 7U},
                                         std::pair{kIterations, 60U},
                                         std::pair{kInterruptEnable, 3U},
                                         std::pair{kRowBeginMemory, 9U},
                                         std::pair{kColumnMemory, 9U}));

class CleanDriver : public testing::TestWithParam<std::vector<const char*> (*)()> {};

TEST_P(CleanDriver, IsCalledClean) {
  Driver driver(GetParam()());
  driver.load();
  for (int i = 0; i < 20; ++i) {
    if (driver.maps) {
      driver.renew_by_dma();
      driver.solve_by_dma();
    } else {
      driver.solve();
    }
  }
  for (const hvp_board_finding& one : driver.findings()) ADD_FAILURE() << one.what;
}

INSTANTIATE_TEST_SUITE_P(All, CleanDriver, testing::Values(blocks, dma, posted));

TEST(DriverRules, EachHasALineInItsPage) {
  const std::string text = text_of("driver-rules.md");
  for (std::size_t i = 0; i < hvp::vp::kDriverRules; ++i) {
    const std::string rule(name(static_cast<hvp::vp::DriverRule>(i)));
    EXPECT_NE(text.find("| `" + rule + "` |"), std::string::npos) << rule;
  }
}

// Nobody watches where nobody asked, and the times are the same.
TEST(DriverRules, AnUnwatchedDriverHasNoFindings) {
  Driver driver(blocks(), false);
  driver.write(0x3c, 1);
  EXPECT_TRUE(driver.findings().empty());
}

}  // namespace
}  // namespace hvp::test::registers
