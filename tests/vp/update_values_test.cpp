// New values for the matrix that is loaded: the words and clocks of a board that was loaded with
// them from the beginning, at every level and under every preconditioner, with contact held.
#include <algorithm>
#include <functional>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/reference_solver.h"
#include "tests/vp/board_rig.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "vp/fpga/accelerator.h"
#include "vp/host/driver_config.h"

namespace hvp::vp::update_values_test {
namespace {

using fixed::Method;
using test::BoardMaster;
using test::kBoardClock;
using test::SmallScene;
using test::Stimulus;
using Words = std::vector<std::int32_t>;

constexpr int kContact = 17;
constexpr std::int32_t kDiagonal = 1'000;

// Other entries of the same pattern, symmetric and positive definite as K is.
fixed::QuantisedMatrix other_than(const fixed::QuantisedMatrix& k) {
  fixed::QuantisedMatrix other = k;
  for (std::int32_t& word : other.value) word = word * 3 / 4;
  for (int node = 0; node < other.block_rows(); ++node) {
    const auto own = static_cast<std::size_t>(other.find(node, node));
    for (std::size_t e = 0; e < 9; e += 4) other.value[9 * own + e] += 5 + node % 7;
  }
  return other;
}

// Counted out: a division has 68 clocks; 48 nodes of three or, for inverse blocks, six a node.
std::int64_t expected_clocks(Method method) {
  switch (method) {
    case Method::jacobi_pcg:
      return 48 * 3 * 68 + 20;
    case Method::block_jacobi_pcg:
      return 48 * 6 * 68 + 20;
    default:
      return 1;
  }
}

std::uint32_t code_of(Method method) {
  return method == Method::cg ? 0 : method == Method::jacobi_pcg ? 1 : 2;
}

class UpdateValues : public test::BoardRig,
                     public testing::TestWithParam<std::tuple<Timing, Method>> {
 protected:
  Method method() const { return std::get<1>(GetParam()); }
  unsigned rhs_bits() const { return method() == Method::cg ? 16 : 32; }

  void run(const std::function<void(Stimulus&, BoardMaster&)>& script) {
    build({}, std::get<0>(GetParam()));
    run_with_line(script);
  }
  void load(BoardMaster& board, const fixed::QuantisedMatrix& matrix) {
    board.poke(Register::method, code_of(method()));
    board.poke(Register::format, 16U << 24 | rhs_bits() << 16 | 16U << 8 | 12U);
    board.load_and_wait(matrix);
    board.poke(Register::interrupt_enable, 3);
  }
  void constrain(BoardMaster& board, int node) {
    board.poke(Register::update_node, static_cast<std::uint32_t>(node));
    board.poke(Register::update_kind, 0);
    board.poke(Register::update_diagonal, kDiagonal);
    board.command(field::kControlUpdateNode);
  }
  void restore(BoardMaster& board, int node, std::span<const std::int32_t> row) {
    board.poke(Register::update_node, static_cast<std::uint32_t>(node));
    board.poke(Register::update_kind, 1);
    board.put(Aperture::row, row, 12);
    board.poke(Register::update_blocks, static_cast<std::uint32_t>(row.size() / 9));
    board.command(field::kControlUpdateNode);
  }
  // Waits for what was commanded then, and returns its clocks.
  std::int64_t wait_for(Stimulus& s, BoardMaster& board, Picoseconds commanded) {
    while (board.peek(field::kStatusBusy) != 0) s.sleep(kBoardClock);
    EXPECT_EQ(board.peek(field::kInterruptStatusError), 0U);
    const Picoseconds took = line_->up.back() - commanded;
    EXPECT_EQ(took % kBoardClock, 0);
    board.clear_interrupts();
    return took / kBoardClock;
  }
  std::int64_t update(Stimulus& s, BoardMaster& board, const Words& values) {
    board.put(Aperture::value, values, 12);
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 0U);
    EXPECT_EQ(board.peek(field::kStatusPatternLoaded), 1U);
    const Picoseconds commanded = now_ps();
    board.command(field::kControlUpdateValues);
    EXPECT_EQ(board.peek(field::kStatusBusy), 1U);
    return wait_for(s, board, commanded);
  }
  Words solve(Stimulus& s, BoardMaster& board, const Words& b) {
    s.sleep(kBoardClock * 100);  // x goes into the copies of d meanwhile
    board.put(Aperture::b, b, rhs_bits());
    const Picoseconds commanded = now_ps();
    board.command(field::kControlStart);
    wait_for(s, board, commanded);
    return board.get(Aperture::u, SmallScene::kUnknowns, 16);
  }
  // The same in the reference's words, from this U.
  Words solved(const fixed::QuantisedMatrix& matrix, const Words& b, Words u) const {
    fixed::Settings settings;
    settings.method = method();
    fixed::ReferenceSolver(settings).solve(matrix, {b, u});
    return u;
  }
};

TEST_P(UpdateValues, GivesTheWordsOfABoardThatWasLoadedWithThem) {
  const fixed::QuantisedMatrix other = other_than(k());
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    load(board, k());
    Words u = solve(s, board, b);
    ASSERT_EQ(u, solved(k(), b, Words(SmallScene::kUnknowns, 0)));
    EXPECT_EQ(update(s, board, other.value), expected_clocks(method()));
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 1U);
    EXPECT_EQ(board.get(Aperture::value, other.value.size(), 12), other.value);
    // U stays: the next job starts from it.
    EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
    u = solved(other, b, u);
    EXPECT_EQ(solve(s, board, b), u);

    // And back again.
    EXPECT_EQ(update(s, board, k().value), expected_clocks(method()));
    EXPECT_EQ(solve(s, board, b), solved(k(), b, u));
  });
}

TEST_P(UpdateValues, KeepsTheContactThatIsHeld) {
  const fixed::QuantisedMatrix other = other_than(k());
  const int neighbour = k().column[static_cast<std::size_t>(k().row_begin[kContact + 1]) - 1];
  ASSERT_NE(neighbour, kContact);
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    load(board, k());
    for (const int node : {kContact, neighbour}) constrain(board, node);
    Words u = solve(s, board, b);

    // The words of a board that was loaded with the new matrix, and then told of the contact.
    fixed::QuantisedMatrix held = other;
    for (const int node : {kContact, neighbour}) held.set_contact(node, kDiagonal);
    update(s, board, other.value);
    EXPECT_EQ(board.get(Aperture::value, held.value.size(), 12), held.value);
    u = solved(held, b, u);
    EXPECT_EQ(solve(s, board, b), u);

    // Nodes that are let go get the new rows.
    held.restore_row(neighbour, other.row(neighbour));
    Words row(other.row(neighbour).begin(), other.row(neighbour).end());
    for (int i = other.row_begin[static_cast<std::size_t>(neighbour)];
         i < other.row_begin[static_cast<std::size_t>(neighbour) + 1]; ++i) {
      if (other.column[static_cast<std::size_t>(i)] != kContact) continue;
      const int block = i - other.row_begin[static_cast<std::size_t>(neighbour)];
      std::fill_n(row.begin() + 9 * block, 9, 0);
    }
    restore(board, neighbour, row);
    EXPECT_EQ(board.get(Aperture::value, held.value.size(), 12), held.value);
    restore(board, kContact, other.row(kContact));
    EXPECT_EQ(board.get(Aperture::value, other.value.size(), 12), other.value);
    EXPECT_EQ(solve(s, board, b), solved(other, b, u));
  });
}

TEST_P(UpdateValues, IsRefusedWithoutAPatternAndWhileTheBoardIsBusy) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.put(Aperture::value, k().value, 12);
    board.command(field::kControlUpdateValues);
    EXPECT_EQ(board.peek(field::kErrorCode), static_cast<std::uint32_t>(ErrorCode::not_loaded));
    board.clear_interrupts();

    load(board, k());
    const Words first = solve(s, board, b);
    const Picoseconds commanded = now_ps();
    board.command(field::kControlStart);
    EXPECT_EQ(board.put(Aperture::value, k().value, 12), tlm::TLM_COMMAND_ERROR_RESPONSE);
    EXPECT_EQ(board.command(field::kControlUpdateValues), tlm::TLM_COMMAND_ERROR_RESPONSE);
    board.clear_interrupts();
    while (board.peek(field::kStatusBusy) != 0) s.sleep(kBoardClock);
    EXPECT_GT(now_ps(), commanded);
    board.clear_interrupts();
    EXPECT_EQ(board.get(Aperture::u, first.size(), 16), solved(k(), b, first));

    // Another pattern, another word length: the board has no place for the values any more.
    board.put(Aperture::column, k().column, 32);
    EXPECT_EQ(board.peek(field::kStatusPatternLoaded), 0U);
    board.command(field::kControlUpdateValues);
    EXPECT_EQ(board.peek(field::kErrorCode), static_cast<std::uint32_t>(ErrorCode::not_loaded));
    board.clear_interrupts();
  });
}

TEST_P(UpdateValues, EntriesBeyondTheirWordLeaveNoMatrix) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    load(board, k());
    Words values = k().value;
    values[9 * static_cast<std::size_t>(k().row_begin[3])] = -2048;
    board.put(Aperture::value, values, 12);
    board.command(field::kControlUpdateValues);
    EXPECT_EQ(board.peek(field::kErrorCode), static_cast<std::uint32_t>(ErrorCode::bad_matrix));
    EXPECT_EQ(board.peek(Register::error_detail), 3U);
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 0U);
    board.clear_interrupts();
    board.command(field::kControlStart);
    EXPECT_EQ(board.peek(field::kErrorCode), static_cast<std::uint32_t>(ErrorCode::not_loaded));
    board.clear_interrupts();
    // The pattern is still there.
    update(s, board, k().value);
    EXPECT_EQ(solve(s, board, b), solved(k(), b, Words(SmallScene::kUnknowns, 0)));
  });
}

TEST_P(UpdateValues, AResetInTheMiddleLeavesNothing) {
  run([&](Stimulus& s, BoardMaster& board) {
    load(board, k());
    board.put(Aperture::value, k().value, 12);
    board.command(field::kControlUpdateValues);
    board.command(field::kControlReset);
    s.sleep(2 * expected_clocks(method()) * kBoardClock);
    EXPECT_EQ(board.peek(Register::status), 0U);
    board.command(field::kControlUpdateValues);
    EXPECT_EQ(board.peek(field::kErrorCode), static_cast<std::uint32_t>(ErrorCode::not_loaded));
  });
}

INSTANTIATE_TEST_SUITE_P(
    Levels, UpdateValues,
    testing::Combine(testing::Values(Timing::loosely_timed, Timing::approximately_timed,
                                     Timing::cycle_accurate),
                     testing::Values(Method::cg, Method::jacobi_pcg, Method::block_jacobi_pcg)));

class UpdateOverABus : public test::BoardRig, public testing::Test {};

// 9 entries of 12 bits a block, two in a word, over PCI 32/33 in bursts of 64 bytes.
TEST_F(UpdateOverABus, TakesTheBytesTheCommandAndTheInterrupt) {
  constexpr Picoseconds kInterrupt = 5 * test::kUs;
  const fixed::QuantisedMatrix other = other_than(k());
  run_driver(kInterrupt, [&](test::Program&) {
    std::vector<std::uint32_t> scratch(3 * 4096);
    ASSERT_EQ(hvp_open(&device_, &port_->bus(), scratch.data(), scratch.size()), HVP_OK);
    const hvp_solver_config config = driver_config({});
    ASSERT_EQ(hvp_configure(&device_, &config), HVP_OK);
    load_matrix(k());
    const Picoseconds began = now_ps();
    ASSERT_EQ(hvp_update_values(&device_, other.value.data(), other.value.size(), 1'000'000),
              HVP_OK);
    access_->time().synchronise();
    const auto bytes = static_cast<int>(2 * (other.value.size() + other.value.size() % 2));
    EXPECT_EQ(now_ps() - began, test::pci_write(bytes) + test::pci_write(4) + kBoardClock +
                                    kInterrupt + test::pci_read(4) + test::pci_write(4));
    Words b = test::words(SmallScene::kUnknowns, 200);
    Words u(b.size());
    ASSERT_EQ(hvp_solve(&device_, b.data(), u.data(), u.size(), 1'000'000'000), HVP_OK);
    Words expected(b.size(), 0);
    fixed::ReferenceSolver(fixed::Settings{}).solve(other, {b, expected});
    EXPECT_EQ(u, expected);
  });
}

}  // namespace
}  // namespace hvp::vp::update_values_test
