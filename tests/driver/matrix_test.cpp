#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"
#include "vp/fpga/register_bank.h"

namespace hvp::test::matrix_test {
namespace {

using Log = std::vector<std::string>;
using vp::Aperture;

std::vector<std::int32_t> unpacked(const vp::RegisterBank& bank, Aperture memory, std::size_t n,
                                   unsigned bits) {
  std::vector<std::int32_t> elements(n);
  for (std::size_t i = 0; i < n; ++i) {
    elements[i] = vp::packed_element(bank.memory(memory), i, bits);
  }
  return elements;
}

TEST_F(DriverOnBoard, LoadsInFourBursts) {
  open();
  const hvp_solver_config config = thesis_config();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  board.take_log();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  // 13 blocks of 9 entries of 12 bits: 117 entries in 59 words.
  EXPECT_EQ(board.take_log(),
            (Log{"write NODES x2", "write ROW_BEGIN[+0x0] x6", "write COLUMN[+0x0] x13",
                 "write VALUE[+0x0] x59", "write CONTROL 0x4", "wait", "read STATUS",
                 "write INTERRUPT_STATUS 0x1"}));
}

class Packing : public DriverOnBoard, public ::testing::WithParamInterface<unsigned> {};

// Every entry arrives where the board looks for it, the extremes of the format too, in bursts that
// are shorter than the matrix.
TEST_P(Packing, MatrixArrives) {
  const unsigned bits = std::min(GetParam(), 24U);  // the board's longest
  const auto largest = static_cast<std::int32_t>((std::int64_t{1} << (bits - 1)) - 1);
  matrix.value[0] = largest;
  matrix.value[1] = -largest - 1;
  matrix.value.back() = -1;
  const hvp_bus bus = board.bus();
  ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), 17), HVP_OK);
  hvp_solver_config config = thesis_config();
  config.matrix_bits = bits;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  EXPECT_EQ(unpacked(board.bank(), Aperture::value, matrix.value.size(), bits), matrix.value);
  EXPECT_EQ(unpacked(board.bank(), Aperture::column, matrix.column.size(), 32), matrix.column);
  EXPECT_EQ(unpacked(board.bank(), Aperture::row_begin, matrix.row_begin.size(), 32),
            matrix.row_begin);
}

INSTANTIATE_TEST_SUITE_P(WordLengths, Packing, ::testing::Values(12U, 16U, 17U, 24U, 32U));

TEST_F(DriverOnBoard, ValuesBeyondTheirWordLengthAreNotSent) {
  open();
  const hvp_solver_config config = thesis_config();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  board.take_log();
  for (const std::int32_t bad : {2048, -2049}) {
    matrix.value[30] = bad;
    const hvp_matrix view = matrix.view();
    EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_RANGE) << bad;
  }
  EXPECT_TRUE(board.take_log().empty());
}

TEST_F(DriverOnBoard, BadPatternsAreNotSent) {
  open();
  const hvp_solver_config config = thesis_config();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  board.take_log();
  const auto load_changed = [this](auto change) {
    ChainMatrix changed(kNodes);
    change(changed);
    const hvp_matrix view = changed.view();
    return hvp_load_matrix(&device, &view);
  };
  EXPECT_EQ(load_changed([](auto& m) { m.row_begin[0] = 1; }), HVP_ERROR_BAD_MATRIX);
  EXPECT_EQ(load_changed([](auto& m) { m.row_begin[2] = 1; }), HVP_ERROR_BAD_MATRIX);
  EXPECT_EQ(load_changed([](auto& m) { m.row_begin[2] = 1000; }), HVP_ERROR_BAD_MATRIX);
  EXPECT_EQ(load_changed([](auto& m) { m.row_begin.back() = 12; }), HVP_ERROR_BAD_MATRIX);
  EXPECT_EQ(load_changed([](auto& m) { std::swap(m.column[0], m.column[1]); }),
            HVP_ERROR_BAD_MATRIX);
  EXPECT_EQ(load_changed([](auto& m) { m.column[0] = -1; }), HVP_ERROR_BAD_MATRIX);
  EXPECT_EQ(load_changed([](auto& m) { m.column.back() = 5; }), HVP_ERROR_BAD_MATRIX);
  EXPECT_EQ(load_changed([](auto& m) { m.column[1] = 2, m.column[0] = 1; }),
            HVP_ERROR_BAD_MATRIX);  // no diagonal block in row 0
  EXPECT_EQ(load_changed([](auto& m) { m = ChainMatrix(65); }), HVP_ERROR_CAPABILITY);
  hvp_matrix nothing = matrix.view();
  nothing.nodes = 0;
  EXPECT_EQ(hvp_load_matrix(&device, &nothing), HVP_ERROR_BAD_SIZE);
  EXPECT_TRUE(board.take_log().empty());
  EXPECT_EQ(load_changed([](auto&) {}), HVP_OK);
}

TEST_F(DriverOnBoard, ConstrainAndRestoreAreInverse) {
  load();
  const auto before = unpacked(board.bank(), Aperture::value, matrix.value.size(), 12);
  ASSERT_EQ(hvp_constrain_node(&device, 2, 900), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write UPDATE_NODE x4", "write CONTROL 0x2"}));

  // Thesis Fig. 3.5: the node's row and column are zero but for the diagonal.
  const auto constrained = unpacked(board.bank(), Aperture::value, matrix.value.size(), 12);
  for (int i = 0; i < kNodes; ++i) {
    for (int k = matrix.row_begin[static_cast<std::size_t>(i)];
         k < matrix.row_begin[static_cast<std::size_t>(i) + 1]; ++k) {
      const int j = matrix.column[static_cast<std::size_t>(k)];
      for (int e = 0; e < 9; ++e) {
        const std::int32_t entry =
            constrained[9 * static_cast<std::size_t>(k) + static_cast<std::size_t>(e)];
        if (i != 2 && j != 2) {
          EXPECT_EQ(entry, ChainMatrix::entry(i, j, e / 3, e % 3));
        } else {
          EXPECT_EQ(entry, i == j && e % 4 == 0 ? 900 : 0);
        }
      }
    }
  }

  const auto first = 9 * static_cast<std::size_t>(matrix.row_begin[2]);
  ASSERT_EQ(hvp_restore_node(&device, 2, matrix.value.data() + first, 3), HVP_OK);
  // 27 entries of 12 bits in 14 words.
  EXPECT_EQ(board.take_log(),
            (Log{"write ROW[+0x0] x14", "write UPDATE_NODE x4", "write CONTROL 0x2"}));
  EXPECT_EQ(unpacked(board.bank(), Aperture::value, matrix.value.size(), 12), before);
}

TEST_F(DriverOnBoard, UpdatesThatCannotBeAreNotSent) {
  load();
  EXPECT_EQ(hvp_constrain_node(&device, kNodes, 1), HVP_ERROR_BAD_NODE);
  EXPECT_EQ(hvp_constrain_node(&device, 0, 0), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_constrain_node(&device, 0, 2048), HVP_ERROR_RANGE);
  EXPECT_EQ(hvp_restore_node(&device, kNodes, matrix.value.data(), 2), HVP_ERROR_BAD_NODE);
  EXPECT_EQ(hvp_restore_node(&device, 0, matrix.value.data(), 0), HVP_ERROR_BAD_ROW);
  EXPECT_EQ(hvp_restore_node(&device, 0, matrix.value.data(), 257), HVP_ERROR_BAD_ROW);
  matrix.value[4] = 5000;
  EXPECT_EQ(hvp_restore_node(&device, 0, matrix.value.data(), 2), HVP_ERROR_RANGE);
  EXPECT_TRUE(board.take_log().empty());
}

// The board alone knows how many blocks the row has; what it reports comes with the next wait.
TEST_F(DriverOnBoard, ARowOfAnotherLengthIsReportedByTheNextWait) {
  load();
  ASSERT_EQ(hvp_restore_node(&device, 0, matrix.value.data(), 3), HVP_OK);
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_ERROR_BAD_ROW);
  EXPECT_EQ(hvp_error_detail(&device), 2U);
  // Nothing is left of it, and the start that was refused has not been counted.
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  hvp_result result{};
  ASSERT_EQ(hvp_read_result(&device, &result), HVP_OK);
  EXPECT_EQ(result.job, 1U);
}

TEST_F(DriverOnBoard, SettingsMayChangeBetweenJobsButNotTheMethodOrTheWordLengths) {
  load();
  hvp_solver_config config = thesis_config();
  config.iterations = 30;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  hvp_solver_config other = config;
  other.matrix_bits = 14;
  ASSERT_EQ(hvp_configure(&device, &other), HVP_OK);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  EXPECT_EQ(board.bank().get(vp::field::kStatusMatrixLoaded), 0U);

  // load_done forms the preconditioner.
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  other = config;
  other.method = HVP_METHOD_CHRONOPOULOS_GEAR;
  ASSERT_EQ(hvp_configure(&device, &other), HVP_OK);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  EXPECT_EQ(board.bank().get(vp::field::kStatusMatrixLoaded), 0U);
}

}  // namespace
}  // namespace hvp::test::matrix_test
