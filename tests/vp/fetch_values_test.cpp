// CONTROL.fetch_values through the board's registers: PCI clocks counted by hand, the words that
// the board solves with then, and everything that a list of values can have wrong.
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/reference_solver.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/memory_rig.h"
#include "vp/bus/host_memory.h"
#include "vp/fpga/accelerator.h"

namespace hvp::vp::fetch_values_test {
namespace {

using test::BoardMaster;
using test::kBoardClock;
using test::kNs;
using test::kUs;
using test::SmallScene;
using test::Stimulus;
using Words = std::vector<std::int32_t>;

constexpr std::uint64_t kList = 0x400;
constexpr std::uint64_t kValues = 0x2000;
constexpr std::size_t kMemoryBytes = 0x10000;
constexpr Picoseconds kEngine = 200 * kNs;

Picoseconds board_read(std::uint32_t bytes) { return test::pci(static_cast<int>(bytes), 4 + 8, 0); }

class FetchValues : public test::MemoryRig, public testing::Test {
 protected:
  static Descriptor to_values(std::uint64_t from, std::uint32_t bytes, std::uint32_t at = 0) {
    return descriptor(false, from, bytes, Aperture::value, at);
  }
  using Script = std::function<void(Stimulus&, BoardMaster&)>;

  void run(const Script& script, const MasterSettings& master = {link::DmaEngine{}, false}) {
    build({}, Timing::loosely_timed, master);
    if (master.present()) connect();
    run_with_line(script);
  }
  void connect() {
    build_bus();
    connect_memory(kMemoryBytes);
  }

  // Half of K, which has the same pattern.
  fixed::QuantisedMatrix other() const {
    fixed::QuantisedMatrix matrix = k();
    for (std::int32_t& word : matrix.value) word /= 2;
    return matrix;
  }
  std::uint32_t bytes() const {
    return static_cast<std::uint32_t>(4 * packed_words(k().value.size(), 12));
  }
  void set_up(BoardMaster& board, const std::vector<Descriptor>& list) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 3);
    put(kValues, test::packed(other().value, 12));
    set_list(board, list);
  }
  void set_list(BoardMaster& board, const std::vector<Descriptor>& list) {
    std::vector<std::uint32_t> words;
    for (const Descriptor& d : list) words.insert(words.end(), d.begin(), d.end());
    put(kList, words);
    board.poke(Register::dma_values_low, kList);
    board.poke(Register::dma_values_count, static_cast<std::uint32_t>(list.size()));
  }
  void put(std::uint64_t address, const std::vector<std::uint32_t>& words) {
    if (words.empty()) return;
    std::memcpy(memory_->bytes().data() + address, words.data(), 4 * words.size());
  }
  // Commands it and waits for the end; what ERROR and its detail say, which it clears.
  std::pair<ErrorCode, std::uint32_t> outcome(Stimulus& s, BoardMaster& board) {
    EXPECT_EQ(board.command(field::kControlFetchValues), tlm::TLM_OK_RESPONSE);
    s.sleep(1'000 * kUs);
    EXPECT_EQ(board.peek(field::kStatusBusy), 0U);
    const auto code = static_cast<ErrorCode>(board.peek(field::kErrorCode));
    const std::uint32_t detail = board.peek(Register::error_detail);
    EXPECT_EQ(board.peek(field::kInterruptStatusDone), code == ErrorCode::none ? 1U : 0U);
    board.clear_interrupts();
    return {code, detail};
  }
  Words solve(Stimulus& s, BoardMaster& board) {
    board.poke(Register::start_mode, 0);
    board.put(Aperture::b, b_, 16);
    board.command(field::kControlStart);
    s.sleep(1'000 * kUs);
    EXPECT_EQ(board.peek(field::kStatusDone), 1U);
    board.clear_interrupts();
    return board.get(Aperture::u, SmallScene::kUnknowns, 16);
  }
  Words solved_with(const fixed::QuantisedMatrix& matrix) const {
    Words u(SmallScene::kUnknowns, 0);
    fixed::ReferenceSolver({}).solve(matrix, {b_, u});
    return u;
  }

  Words b_ = test::words(SmallScene::kUnknowns, 200);
};

TEST_F(FetchValues, TakesItsClocksAndItsSpansFollowEachOther) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {to_values(kValues, bytes() - 100),
                   to_values(kValues + bytes() - 100, 100, bytes() - 100)});
    ledger_.open(7, now_ps());
    Tag tag{7, kBirth};
    const Picoseconds commanded = now_ps();
    board.poke(Register::control, field::kControlFetchValues.mask(), &tag);
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 0U);
    EXPECT_EQ(board.peek(field::kStatusPatternLoaded), 1U);
    const std::array<std::pair<Phase, Picoseconds>, 5> steps = {
        {{Phase::dma_engine, kEngine},
         {Phase::descriptor, board_read(64)},
         {Phase::dma_read, board_read(bytes() - 100)},
         {Phase::dma_read, board_read(100)},
         {Phase::load_values, kBoardClock}}};
    s.sleep(1'000 * kUs);
    const std::vector<Span>& spans = ledger_.frame(7).spans;
    ASSERT_EQ(spans.size(), steps.size());
    Picoseconds at = commanded;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      EXPECT_EQ(spans[i].phase, steps[i].first) << i;
      EXPECT_EQ(spans[i].start, at) << i;
      at += steps[i].second;
      EXPECT_EQ(spans[i].end, at) << i;
    }
    EXPECT_EQ(line_->up.back(), at);
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 1U);
    EXPECT_EQ(board.peek(Register::job), 0U);  // it is no job
    board.clear_interrupts();
    EXPECT_EQ(solve(s, board), solved_with(other()));
  });
}

TEST_F(FetchValues, KeepsTheContactThatIsHeld) {
  constexpr int kContact = 17;
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {to_values(kValues, bytes())});
    board.poke(Register::update_node, kContact);
    board.poke(Register::update_kind, 0);
    board.poke(Register::update_diagonal, 1000);
    board.command(field::kControlUpdateNode);
    EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
    fixed::QuantisedMatrix expected = other();
    expected.set_contact(kContact, 1000);
    EXPECT_EQ(board.get(Aperture::value, expected.value.size(), 12), expected.value);
    EXPECT_EQ(solve(s, board), solved_with(expected));
  });
}

TEST_F(FetchValues, IsRefusedWithoutAPatternAListOrAnEngine) {
  run([this](Stimulus& s, BoardMaster& board) {
    EXPECT_EQ(outcome(s, board).first, ErrorCode::not_loaded);
    set_up(board, {to_values(kValues, bytes())});
    board.poke(Register::dma_values_low, kList + 4);
    EXPECT_EQ(outcome(s, board),
              std::pair(ErrorCode::bad_setting,
                        static_cast<std::uint32_t>(test::offset_of(Register::dma_values_low))));
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 1U);
    EXPECT_EQ(solve(s, board), solved_with(k()));
  });
}

TEST_F(FetchValues, ABoardWithoutAnEngineSaysSo) {
  run(
      [this](Stimulus& s, BoardMaster& board) {
        board.load_and_wait(k());
        EXPECT_EQ(outcome(s, board),
                  std::pair(ErrorCode::bad_setting,
                            static_cast<std::uint32_t>(test::offset_of(Register::capability_dma))));
        EXPECT_EQ(solve(s, board), solved_with(k()));
      },
      {});
}

// Each leaves the board without a matrix and with its pattern, and the next list is taken.
TEST_F(FetchValues, WhatAListCanHaveWrong) {
  run([this](Stimulus& s, BoardMaster& board) {
    const Descriptor whole = to_values(kValues, bytes());
    set_up(board, {whole});
    const auto expect = [&](const std::vector<Descriptor>& list, ErrorCode code,
                            std::uint32_t detail) {
      set_list(board, list);
      EXPECT_EQ(outcome(s, board), std::pair(code, detail));
      EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 0U);
      EXPECT_EQ(board.peek(field::kStatusPatternLoaded), 1U);
      board.command(field::kControlStart);
      EXPECT_EQ(board.peek(field::kErrorCode), static_cast<std::uint32_t>(ErrorCode::not_loaded));
      board.clear_interrupts();
      set_list(board, {whole});
      EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
      EXPECT_EQ(solve(s, board), solved_with(other()));
    };
    const auto changed = [&](std::size_t word, std::uint32_t value) {
      Descriptor d = whole;
      d[word] = value;
      return d;
    };
    expect({changed(0, 1)}, ErrorCode::bad_descriptor, 0);         // to the host
    expect({whole, changed(1, 0)}, ErrorCode::bad_descriptor, 1);  // no bytes
    expect({changed(1, 6)}, ErrorCode::bad_descriptor, 0);
    expect({changed(5, 1)}, ErrorCode::bad_descriptor, 0);
    expect({changed(4, static_cast<std::uint32_t>(test::offset_of(Aperture::b)))},
           ErrorCode::bad_descriptor, 0);
    expect({changed(4, whole[4] - 4)}, ErrorCode::bad_descriptor, 0);
    expect({changed(1, 0xffff'fffc)}, ErrorCode::bad_descriptor, 0);
    expect({whole, changed(2, kMemoryBytes)}, ErrorCode::dma_failed, 1);
    board.poke(Register::dma_values_high, 1);
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::dma_failed, kListFailed));
    board.poke(Register::dma_values_high, 0);
    EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
  });
}

TEST_F(FetchValues, EntriesBeyondTheirWordLeaveNoMatrix) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {to_values(kValues, bytes())});
    Words values = k().value;
    values[9 * static_cast<std::size_t>(k().row_begin[3])] = -2048;
    put(kValues, test::packed(values, 12));
    EXPECT_EQ(outcome(s, board), std::pair(ErrorCode::bad_matrix, 3U));
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 0U);
    put(kValues, test::packed(other().value, 12));
    EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
    EXPECT_EQ(solve(s, board), solved_with(other()));
  });
}

// Wherever it is: the board is as after power-up, and what was on the bus does not arrive.
TEST_F(FetchValues, AResetGivesItUpWhereverItIs) {
  run([this](Stimulus& s, BoardMaster& board) {
    const Picoseconds whole = kEngine + board_read(32) + board_read(bytes()) + kBoardClock;
    int resets = 0;
    for (Picoseconds after = 0; after < whole + 2 * kUs; after += 1'870 * kNs, ++resets) {
      set_up(board, {to_values(kValues, bytes())});
      board.command(field::kControlFetchValues);
      s.sleep(after);
      board.command(field::kControlReset);
      EXPECT_EQ(board.peek(Register::status), 0U);
      s.sleep(whole);
      EXPECT_EQ(board.peek(Register::status), 0U);
      const std::vector<std::uint32_t> words = board.get(Aperture::value, bytes() / 4);
      EXPECT_TRUE(std::ranges::all_of(words, [](std::uint32_t word) { return word == 0; }))
          << after;
    }
    EXPECT_GT(resets, 40);
    // While the old transaction is still on the bus.
    set_up(board, {to_values(kValues, bytes())});
    board.command(field::kControlFetchValues);
    s.sleep(2 * kUs);
    board.command(field::kControlReset);
    set_up(board, {to_values(kValues, bytes())});
    EXPECT_EQ(outcome(s, board).first, ErrorCode::none);
    EXPECT_EQ(solve(s, board), solved_with(other()));
  });
}

TEST_F(FetchValues, NothingElseIsTakenMeanwhile) {
  run([this](Stimulus& s, BoardMaster& board) {
    set_up(board, {to_values(kValues, bytes())});
    board.command(field::kControlFetchValues);
    s.sleep(5 * kUs);
    for (const Field command : {field::kControlStart, field::kControlFetchValues,
                                field::kControlUpdateValues, field::kControlRunList}) {
      EXPECT_EQ(board.command(command), tlm::TLM_COMMAND_ERROR_RESPONSE);
    }
    EXPECT_EQ(board.poke(Register::dma_values_count, 0), tlm::TLM_COMMAND_ERROR_RESPONSE);
    board.clear_interrupts();
    s.sleep(1'000 * kUs);
    board.clear_interrupts();
    EXPECT_EQ(solve(s, board), solved_with(other()));
  });
}

}  // namespace
}  // namespace hvp::vp::fetch_values_test
