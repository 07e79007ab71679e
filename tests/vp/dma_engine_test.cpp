// The board's DMA engine through its registers: PCI clocks counted by hand, and everything that a
// list can have wrong.
#include "vp/fpga/dma_engine.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/reference_solver.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/memory_rig.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/bus/host_memory.h"
#include "vp/fpga/accelerator.h"
#include "vp/pci/pci_bus.h"

namespace hvp::vp::dma_engine_test {
namespace {

using test::BoardMaster;
using test::kNs;
using test::kPciClock;
using test::kUs;
using test::SmallScene;
using test::Stimulus;

constexpr std::uint64_t kList = 0x400;
constexpr std::uint64_t kRecord = 0x40;
constexpr std::uint64_t kB = 0x2000;
constexpr std::uint64_t kU = 0x3000;
constexpr std::size_t kMemoryBytes = 0x4000;
constexpr std::uint32_t kVectorBytes = 2 * SmallScene::kUnknowns;
constexpr Picoseconds kEngine = 200 * kNs;

// The board's bursts on PCI 32/33, without the processor's way.
Picoseconds board_write(int bytes) { return test::pci(bytes, 4, 0); }
Picoseconds board_read(int bytes) { return test::pci(bytes, 4 + 8, 0); }

class DmaEngineTest : public test::MemoryRig, public testing::Test {
 protected:
  static Descriptor to_board(std::uint64_t from, std::uint32_t bytes, std::uint32_t at = 0) {
    return descriptor(false, from, bytes, Aperture::b, at);
  }
  static Descriptor to_host(std::uint64_t to, std::uint32_t bytes, std::uint32_t at = 0) {
    return descriptor(true, to, bytes, Aperture::u, at);
  }
  using Script = std::function<void(Stimulus&, BoardMaster&)>;

  // The board's requests go over a PCI bus; the script's accesses reach its registers at once.
  void run(const Script& script, const MasterSettings& master = {link::DmaEngine{}, false}) {
    build_bus();
    build({}, Timing::loosely_timed, master);
    connect_memory(kMemoryBytes);
    if (!master.messages) {
      run_with_line(script);
      return;
    }
    line_ = std::make_unique<test::LineProbe>("line");
    memory_->interrupt.bind(*line_);
    run_at_registers(script);
  }

  void set_up(BoardMaster& board, const std::vector<Descriptor>& there,
              const std::vector<Descriptor>& back) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 3);
    put(kB, test::packed(b_, 16));
    set_list(board, there, back);
  }
  void set_list(BoardMaster& board, const std::vector<Descriptor>& there,
                const std::vector<Descriptor>& back) {
    std::vector<std::uint32_t> words;
    for (const auto* part : {&there, &back}) {
      for (const Descriptor& d : *part) words.insert(words.end(), d.begin(), d.end());
    }
    put(kList, words);
    board.poke(Register::dma_list_low, kList);
    board.poke(Register::dma_count, static_cast<std::uint32_t>(there.size() | back.size() << 16));
    board.poke(Register::dma_record_low, kRecord);
  }
  void put(std::uint64_t address, const std::vector<std::uint32_t>& words) {
    if (words.empty()) return;
    std::memcpy(memory_->bytes().data() + address, words.data(), 4 * words.size());
  }
  CompletionRecord record() const {
    CompletionRecord words{};
    std::memcpy(words.data(), memory_->bytes().data() + kRecord, sizeof words);
    return words;
  }
  std::vector<std::int32_t> u_in_memory(std::uint64_t address = kU) const {
    std::vector<std::uint32_t> words(kVectorBytes / 4);
    std::memcpy(words.data(), memory_->bytes().data() + address, kVectorBytes);
    std::vector<std::int32_t> u;
    for (std::size_t i = 0; i < SmallScene::kUnknowns; ++i) {
      u.push_back(packed_element(words, i, 16));
    }
    return u;
  }
  std::vector<std::int32_t> expected() const { return solution(b_); }
  // Rings and waits for the end; what ERROR and its detail say, which it clears.
  std::pair<ErrorCode, std::uint32_t> outcome(Stimulus& s, BoardMaster& board) {
    EXPECT_EQ(board.command(field::kControlRunList), tlm::TLM_OK_RESPONSE);
    s.sleep(1'000 * kUs);
    EXPECT_EQ(board.peek(field::kStatusBusy), 0U);
    const auto code = static_cast<ErrorCode>(board.peek(field::kErrorCode));
    const std::uint32_t detail = board.peek(Register::error_detail);
    EXPECT_EQ(board.peek(field::kInterruptStatusDone), code == ErrorCode::none ? 1U : 0U);
    board.clear_interrupts();
    return {code, detail};
  }

  std::vector<std::int32_t> b_ = test::words(SmallScene::kUnknowns, 200);
};

TEST_F(DmaEngineTest, ListTakesItsClocksAndItsSpansFollowEachOther) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {to_board(kB, kVectorBytes)}, {to_host(kU, kVectorBytes)});
    EXPECT_EQ(board.peek(Register::capability_dma), DmaEngine::kMaxDescriptors);
    ledger_.open(7, now_ps());
    Tag tag{7, kBirth};
    const Picoseconds rung = now_ps();
    board.poke(Register::control, field::kControlRunList.mask(), &tag);
    const std::array<std::pair<Phase, Picoseconds>, 7> steps = {
        {{Phase::dma_engine, kEngine},
         {Phase::descriptor, board_read(64)},
         {Phase::dma_read, board_read(kVectorBytes)},
         {Phase::solve, solve_time()},
         {Phase::dma_engine, kEngine},
         {Phase::dma_write, board_write(kVectorBytes)},
         {Phase::dma_write, board_write(32)}}};
    Picoseconds end = rung;
    for (const auto& [phase, time] : steps) end += time;
    s.sleep_until(end - 1);
    EXPECT_EQ(board.peek(Register::status) & 7U, 1U);  // busy alone
    s.sleep(1);
    s.sleep(0);
    EXPECT_EQ(board.peek(Register::status) & 7U, 2U);  // done
    ASSERT_EQ(line_->up.size(), 1U);
    EXPECT_EQ(line_->up[0], end);
    EXPECT_EQ(u_in_memory(), expected());

    const std::vector<Span>& spans = ledger_.frame(7).spans;
    ASSERT_EQ(spans.size(), 7U);
    Picoseconds at = rung;
    for (std::size_t i = 0; i < spans.size(); ++i) {
      EXPECT_EQ(spans[i].phase, steps[i].first) << i;
      EXPECT_EQ(spans[i].start, at) << i;
      EXPECT_EQ(spans[i].cause, static_cast<SpanId>(i) - 1);
      at += steps[i].second;
      EXPECT_EQ(spans[i].end, at) << i;
    }
    EXPECT_EQ(line_->tags[0].cause, 6);

    const CompletionRecord words = record();
    EXPECT_EQ(words[0], board.peek(Register::status));
    EXPECT_EQ(words[1], kVectorBytes);
    EXPECT_EQ(words[2], kVectorBytes);
    EXPECT_EQ(words[3], board.peek(Register::result_iterations));
    EXPECT_EQ(words[5], board.peek(Register::result_cycles_low));
    EXPECT_EQ(words[7], 1U);
    // Nothing holds the frame any more.
    ledger_.frame(7).force_at_motor = 6;
    ledger_.close(7);
    EXPECT_NO_THROW(ledger_.finish());
  });
}

TEST_F(DmaEngineTest, MessageComesBehindTheRecord) {
  run(
      [this](Stimulus& s, BoardMaster& board) {
        set_up(board, {to_board(kB, kVectorBytes)}, {to_host(kU, kVectorBytes)});
        const std::size_t before = line_->up.size();
        const Picoseconds rung = now_ps();
        board.command(field::kControlRunList);
        s.sleep(1'000 * kUs);
        ASSERT_EQ(line_->up.size(), before + 1);
        EXPECT_EQ(line_->up.back(), rung + 2 * kEngine + board_read(64) + board_read(kVectorBytes) +
                                        solve_time() + board_write(kVectorBytes) + board_write(32) +
                                        board_write(4));
        EXPECT_EQ(record()[7], 1U);
        EXPECT_TRUE(line_->down.empty());  // messages are edges
        // done is still up: the next list takes it down and has a message of its own.
        board.command(field::kControlRunList);
        EXPECT_EQ(board.peek(field::kStatusDone), 0U);
        s.sleep(1'000 * kUs);
        EXPECT_EQ(line_->up.size(), before + 2);
        EXPECT_EQ(record()[7], 2U);
      },
      {link::DmaEngine{}, true});
}

TEST_F(DmaEngineTest, MessagesNeedNoEngine) {
  run(
      [this](Stimulus& s, BoardMaster& board) {
        board.load_and_wait(k());
        board.poke(Register::interrupt_enable, 3);
        board.put(Aperture::b, b_, 16);
        const Picoseconds started = now_ps();
        board.command(field::kControlStart);
        s.sleep(1'000 * kUs);
        ASSERT_EQ(line_->up.size(), 1U);
        EXPECT_EQ(line_->up[0], started + solve_time() + board_write(4));
        EXPECT_EQ(board.peek(Register::capability_dma), 0U);
        EXPECT_EQ(outcome(s, board),
                  std::pair(ErrorCode::bad_setting,
                            static_cast<std::uint32_t>(test::offset_of(Register::capability_dma))));
      },
      {std::nullopt, true});
}

TEST_F(DmaEngineTest, SegmentsNeedNotLieTogether) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {}, {});
    // b backwards in memory, U in three places.
    const std::vector<std::uint32_t> words = test::packed(b_, 16);
    const std::size_t half = words.size() / 2;
    put(0x2800, {words.begin(), words.begin() + static_cast<std::ptrdiff_t>(half)});
    put(0x2100, {words.begin() + static_cast<std::ptrdiff_t>(half), words.end()});
    const auto first = static_cast<std::uint32_t>(4 * half);
    set_list(board, {to_board(0x2800, first), to_board(0x2100, kVectorBytes - first, first)},
             {to_host(kU + 8, kVectorBytes - 8, 8), to_host(kU, 4), to_host(kU + 4, 4, 4)});
    EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
    EXPECT_EQ(u_in_memory(), expected());
  });
}

TEST_F(DmaEngineTest, DescriptorsCanBeFetchedOneByOne) {
  link::DmaEngine engine;
  engine.prefetches_descriptors = false;
  run(
      [this](Stimulus& s, BoardMaster& board) {
        set_up(board, {to_board(kB, 100), to_board(kB + 100, kVectorBytes - 100, 100)},
               {to_host(kU, kVectorBytes)});
        const Picoseconds rung = now_ps();
        board.command(field::kControlRunList);
        s.sleep(1'000 * kUs);
        ASSERT_EQ(line_->up.size(), 1U);
        EXPECT_EQ(line_->up[0], rung + 2 * kEngine + 3 * board_read(32) + board_read(100) +
                                    board_read(kVectorBytes - 100) + solve_time() +
                                    board_write(kVectorBytes) + board_write(32));
        EXPECT_EQ(u_in_memory(), expected());
      },
      {engine, false});
}

TEST_F(DmaEngineTest, EveryWrongDescriptorIsNamedByItsPlace) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {}, {});
    const Descriptor there = to_board(kB, kVectorBytes);
    const Descriptor back = to_host(kU, kVectorBytes);
    const auto changed = [](Descriptor d, std::size_t word, std::uint32_t value) {
      d[word] = value;
      return d;
    };
    const auto b_end = static_cast<std::uint32_t>(
        test::offset_of(Aperture::b) + 4 * accelerator_->bank().memory(Aperture::b).size());
    const std::vector<Descriptor> wrong = {
        changed(there, 0, 1),                             // against the list's order
        changed(there, 0, 2),                             // reserved bits
        changed(there, 1, 0),                             // no bytes
        changed(there, 1, 6),                             // half a word
        changed(there, 1, 0xffff'fffc),                   // longer than B
        changed(there, 2, kB + 2),                        // a misaligned address
        changed(changed(there, 2, 0xffff'fffc), 3, ~0U),  // round the end of the address space
        changed(there, 4, there[4] + 2),                  // a misaligned offset
        changed(there, 4, there[4] - 4),                  // before B
        changed(there, 4, b_end - 4),                     // over the end of B
        changed(there, 4, b_end),                         //
        changed(there, 4, 0),                             // registers
        changed(there, 4, back[4]),                       // U
        changed(there, 4, 0xffff'fffc),                   // beyond the BAR
        changed(there, 5, 1),
        changed(there, 6, 1),
        changed(there, 7, 1),
        Descriptor{},
    };
    std::uint32_t job = 0;
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      set_list(board, {there, wrong[i]}, {back});
      EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::bad_descriptor, 1U)) << i;
      EXPECT_EQ(record()[7], ++job);
      EXPECT_EQ(record()[0] >> 8 & 0xff, static_cast<std::uint32_t>(ErrorCode::bad_descriptor));
      EXPECT_EQ(record()[1], kVectorBytes);
    }
    set_list(board, {there}, {back, changed(back, 4, there[4])});
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::bad_descriptor, 2U));
    EXPECT_EQ(record()[2], kVectorBytes);
    // And the board goes on.
    set_list(board, {there}, {back});
    EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
  });
}

TEST_F(DmaEngineTest, MemoryThatDoesNotAnswerIsNamed) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {}, {});
    const Descriptor there = to_board(kB, kVectorBytes);
    const Descriptor back = to_host(kU, kVectorBytes);
    set_list(board, {there, to_board(kMemoryBytes - 4, 8)}, {back});
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::dma_failed, 1U));
    set_list(board, {there, to_board(std::uint64_t{1} << 40, 8)}, {back});
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::dma_failed, 1U));
    set_list(board, {there}, {back, to_host(kMemoryBytes, 4)});
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::dma_failed, 2U));
    set_list(board, {there}, {back});
    board.poke(Register::dma_list_high, 1);
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::dma_failed, kListFailed));
    board.poke(Register::dma_list_high, 0);
    put(kRecord, std::vector<std::uint32_t>(8, 0));
    board.poke(Register::dma_record_high, 1);
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::dma_failed, kRecordFailed));
    EXPECT_EQ(record()[7], 0U);
  });
}

TEST_F(DmaEngineTest, DoorbellThatCannotBeAnsweredIsRefusedAtOnce) {
  run([this](Stimulus& s, BoardMaster& board) {
    const auto offset = [](Register reg) {
      return static_cast<std::uint32_t>(test::offset_of(reg));
    };
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::not_loaded, 0U));
    set_up(board, {to_board(kB, kVectorBytes)}, {to_host(kU, kVectorBytes)});
    const auto refused = [&](Register reg, std::uint32_t value, Register blamed) {
      const std::uint32_t right = board.peek(reg);
      board.poke(reg, value);
      EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::bad_setting, offset(blamed)));
      board.poke(reg, right);
    };
    refused(Register::dma_count, 256U | 1U << 16, Register::dma_count);
    refused(Register::dma_count, 0xffff'ffff, Register::dma_count);
    refused(Register::dma_list_low, kList + 4, Register::dma_list_low);
    refused(Register::dma_record_low, kRecord + 16, Register::dma_record_low);
    refused(Register::iterations, 0, Register::iterations);
    EXPECT_EQ(board.peek(Register::job), 0U);  // none of them counted
    EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
  });
}

TEST_F(DmaEngineTest, AnEmptyListSolvesWhatIsThere) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {}, {});
    board.put(Aperture::b, b_, 16);
    EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
    EXPECT_EQ(board.get(Aperture::u, SmallScene::kUnknowns, 16), expected());
    EXPECT_EQ(record()[1] + record()[2], 0U);
  });
}

TEST_F(DmaEngineTest, RegistersAreLockedFromTheDoorbellToTheRecord) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {to_board(kB, kVectorBytes)}, {to_host(kU, kVectorBytes)});
    const Picoseconds rung = now_ps();
    board.command(field::kControlRunList);
    const Picoseconds solved =
        rung + kEngine + board_read(64) + board_read(kVectorBytes) + solve_time();
    for (const Picoseconds at : {rung + kNs, rung + 2 * kUs, solved - kUs, solved + kUs}) {
      s.sleep_until(at);
      EXPECT_EQ(board.command(field::kControlRunList), tlm::TLM_COMMAND_ERROR_RESPONSE);
      EXPECT_EQ(board.command(field::kControlStart), tlm::TLM_COMMAND_ERROR_RESPONSE);
      EXPECT_EQ(board.poke(Register::dma_count, 0), tlm::TLM_COMMAND_ERROR_RESPONSE);
      EXPECT_EQ(board.poke(Register::packing, 1), tlm::TLM_COMMAND_ERROR_RESPONSE);
      board.clear_interrupts();
    }
    s.sleep(1'000 * kUs);
    EXPECT_EQ(u_in_memory(), expected());
    EXPECT_EQ(record()[7], 1U);
  });
}

// At every step of a list: nothing of it is seen afterwards but a burst that was on the bus, the
// frame can be closed, and the next list is whole.
TEST_F(DmaEngineTest, ResetGivesTheListUpWhereverItIs) {
  run([this](Stimulus& s, BoardMaster& board) {
    std::int64_t frame = 0;
    const Picoseconds whole = 2 * kEngine + board_read(64) + board_read(kVectorBytes) +
                              solve_time() + board_write(kVectorBytes) + board_write(32);
    for (Picoseconds after = 0; after < whole + 2 * kUs; after += 330 * kNs) {
      if (after > 6 * kUs && after < whole - 8 * kUs) after = whole - 8 * kUs;
      set_up(board, {to_board(kB, kVectorBytes)}, {to_host(kU, kVectorBytes)});
      put(kRecord, std::vector<std::uint32_t>(8, 0));
      ledger_.open(++frame, now_ps());
      Tag tag{frame, kBirth};
      board.poke(Register::control, field::kControlRunList.mask(), &tag);
      s.sleep(after);
      const std::uint32_t job = record()[7];
      board.command(field::kControlReset);
      EXPECT_EQ(board.peek(Register::status), 0U);
      ledger_.frame(frame).spans.push_back(
          {Part::host, Phase::release, ledger_.frame(frame).born, now_ps(), kBirth});
      ledger_.frame(frame).force_at_motor =
          static_cast<SpanId>(ledger_.frame(frame).spans.size()) - 1;
      ledger_.close(frame);
      EXPECT_NO_THROW(ledger_.finish());
      // The doorbell may come while the old transaction is still on the bus.
      set_up(board, {to_board(kB, kVectorBytes)}, {to_host(kU, kVectorBytes)});
      ledger_.open(++frame, now_ps());
      Tag next{frame, kBirth};
      board.poke(Register::control, field::kControlRunList.mask(), &next);
      s.sleep(whole + 20 * kUs);
      EXPECT_EQ(board.peek(field::kStatusDone), 1U);
      EXPECT_EQ(record()[7], 1U) << "the job before had " << job;
      EXPECT_EQ(u_in_memory(), expected());
      for (const Span& span : ledger_.frame(frame).spans) {
        EXPECT_GE(span.start, ledger_.frame(frame).born);
      }
      const std::vector<Span>& spans = ledger_.frame(frame).spans;
      ledger_.frame(frame).force_at_motor = static_cast<SpanId>(spans.size()) - 1;
      ledger_.close(frame);  // throws where the spans have a gap
      EXPECT_NO_THROW(ledger_.finish());
      board.command(field::kControlReset);
    }
    EXPECT_GT(frame, 40);
  });
}

// Whatever software does to registers, lists and memory, with doorbells and resets at any time:
// each list ends, and after a reset the board solves.
TEST_F(DmaEngineTest, ComesBackAfterThousandsOfRandomLists) {
  constexpr std::array<Register, 12> kSome = {
      Register::dma_list_low,     Register::dma_list_high,    Register::dma_count,
      Register::dma_record_low,   Register::dma_record_high,  Register::dma_values_low,
      Register::dma_values_high,  Register::dma_values_count, Register::interrupt_status,
      Register::interrupt_enable, Register::packing,          Register::static_shift};
  std::uint32_t state = 1;
  const auto random = [&state](std::uint32_t below) {
    state = state * 1664525U + 1013904223U;  // Knuth's congruential generator
    return (state >> 8) % below;
  };
  run(
      [&](Stimulus& s, BoardMaster& board) {
        std::int64_t frame = 0;
        for (int round = 0; round < 3'000; ++round) {
          if (round % 6 == 0) {
            board.command(field::kControlReset);
            set_up(board, {}, {});
            board.poke(Register::iterations, 1);
          }
          std::vector<Descriptor> there, back;
          for (std::uint32_t i = random(3); i > 0; --i) {
            there.push_back(to_board(kB + 4 * random(16), 4 * random(80), 4 * random(64)));
          }
          for (std::uint32_t i = random(3); i > 0; --i) {
            back.push_back(to_host(kU + 4 * random(16), 4 * random(80), 4 * random(64)));
          }
          if (random(4) == 0 && !there.empty()) there[0][random(8)] = random(1U << 24) << random(9);
          set_list(board, there, back);
          if (random(8) == 0)
            board.poke(kSome[random(kSome.size())], random(1U << 24) << random(9));
          ledger_.open(++frame, now_ps());
          Tag tag{frame, kBirth};
          // A list of b and U is none of values, but for its form.
          if (random(8) == 0) {
            board.poke(Register::dma_values_low, kList);
            board.poke(Register::dma_values_count, random(4));
            board.command(field::kControlFetchValues, &tag);
            s.sleep(random(2) == 0 ? random(30'000) * kNs : 1'000 * kUs);
          }
          board.poke(Register::control, field::kControlRunList.mask(), &tag);
          s.sleep(random(4) == 0 ? random(30'000) * kNs : 1'000 * kUs);
          if (random(8) == 0) board.command(field::kControlReset);
          for (int waits = 0; board.peek(field::kStatusBusy) != 0; ++waits) {
            ASSERT_LT(waits, 100) << "round " << round;
            s.sleep(100 * kUs);
          }
          board.clear_interrupts();
          s.sleep(10 * kUs);
          Frame& open = ledger_.frame(frame);
          open.spans.push_back({Part::host, Phase::release, open.born, now_ps(), kBirth});
          open.force_at_motor = static_cast<SpanId>(open.spans.size()) - 1;
          ledger_.close(frame);
          ASSERT_NO_THROW(ledger_.finish()) << "round " << round;
        }
        EXPECT_GT(accelerator_->dma()->lists(), 1'000);
        board.command(field::kControlReset);
        set_up(board, {to_board(kB, kVectorBytes)}, {to_host(kU, kVectorBytes)});
        EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
        EXPECT_EQ(u_in_memory(), expected());
      },
      {link::DmaEngine{}, true});
}

TEST_F(DmaEngineTest, WithoutAMemoryEveryTransferFails) {
  build({}, Timing::loosely_timed, {link::DmaEngine{}, true});
  run_at_registers([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 3);
    board.poke(Register::dma_count, 1);
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::dma_failed, kListFailed));
  });
}

}  // namespace
}  // namespace hvp::vp::dma_engine_test
