#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fixed/system.h"

namespace hvp::fixed::scaling_test {
namespace {

TEST(Scaling, UnitsFollowFromRangeAndShift) {
  Settings s;
  s.displacement_range = 0.032767;
  const Scaling cg(s, 2.5);
  EXPECT_DOUBLE_EQ(cg.displacement_unit(), 1e-6);
  EXPECT_DOUBLE_EQ(cg.force_unit(), 2.5 * 1e-6 * 2048);
  s.method = Method::jacobi_pcg;
  EXPECT_DOUBLE_EQ(Scaling(s, 2.5).force_unit(), 2.5 * 1e-6);
  s.matrix_bits = 18;
  s.vector_bits = 24;  // 14 bits more than 32-bit products hold
  s.displacement_range = 8.388607;
  EXPECT_DOUBLE_EQ(Scaling(s, 1).force_unit(), 1e-6 * 16384);
}

TEST(Scaling, RoundsToNearestClampsAndCounts) {
  Settings s;
  s.displacement_range = 32767;  // one metre a unit
  const Scaling scaling(s, 1.0 / 2048);
  ASSERT_EQ(scaling.force_unit(), 1.0);
  const std::vector<double> in = {0.49, 0.5, -0.5, 1.5, 32767.4, 32768, -1e300, 0};
  std::vector<std::int32_t> words(in.size());
  const std::vector<std::int32_t> expected = {0, 1, -1, 2, 32767, 32767, -32767, 0};
  EXPECT_EQ(scaling.right_hand_side(in, words), 2);
  EXPECT_EQ(words, expected);
  EXPECT_EQ(scaling.displacement_words(in, words), 2);
  EXPECT_EQ(words, expected);
  std::vector<double> back(in.size());
  scaling.displacements(words, back);
  EXPECT_EQ(back[3], 2.0);
}

// std::round, but for a magnitude beyond the word: around every tie, and at the end of the widest.
TEST(Scaling, RoundsAsTheLibraryDoes) {
  Settings s;
  s.vector_bits = 32;
  s.displacement_range = 2147483647;  // one metre a unit
  const Scaling scaling(s, 1);
  ASSERT_EQ(scaling.displacement_unit(), 1.0);
  std::vector<double> in;
  for (const double whole : {0.0, 1.0, 2.0, 3.0, 32767.0, 1e9, 2147483645.0, 2147483646.0}) {
    for (const double part : {0.0, 0.25, 0.5, 0.75}) {
      for (const double sign : {1.0, -1.0}) {
        const double value = sign * (whole + part);
        in.push_back(value);
        in.push_back(std::nextafter(value, 1e300));
        in.push_back(std::nextafter(value, -1e300));
      }
    }
  }
  in.push_back(5e-324);
  std::vector<std::int32_t> words(in.size());
  EXPECT_EQ(scaling.displacement_words(in, words), 0);
  for (std::size_t i = 0; i < in.size(); ++i) EXPECT_EQ(words[i], std::round(in[i])) << in[i];
}

TEST(Scaling, RefusesWhatIsNotANumberOrDoesNotFit) {
  const Scaling scaling(Settings{}, 1.0);
  std::vector<std::int32_t> words(1);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(scaling.right_hand_side(std::vector<double>{bad}, words), InputError);
    EXPECT_THROW(scaling.displacement_words(std::vector<double>{bad}, words), InputError);
  }
  EXPECT_THROW(scaling.right_hand_side(std::vector<double>(2), words), InputError);
  EXPECT_THROW(Scaling(Settings{}, 0.0), InputError);
  EXPECT_THROW(Scaling(Settings{}, std::nan("")), InputError);
}

// Diagonal entries 4 and 64: s = 1/2 and 1/8, and S·A·S has ones on its diagonal.
sparse::BlockMatrix diagonal_matrix() {
  sparse::BlockMatrix a;
  a.row_begin = {0, 1};
  a.column = {0};
  a.value = {4, 0, 0, 0, 64, 0, 0, 0, 4};
  return a;
}

TEST(Scaling, OfAScaledMatrixTranslatesBothVectors) {
  Settings s;
  s.matrix_scaling = MatrixScaling::diagonal;
  s.displacement_range = 32767.0 / 8;
  const System system = prepare(diagonal_matrix(), s);
  const Scaling scaling(system);
  // The stiffest equation has s = 1/8: y = 8·x, so that x = 32767/8 is the largest word.
  EXPECT_DOUBLE_EQ(scaling.displacement_unit(), 1.0);
  EXPECT_DOUBLE_EQ(scaling.force_unit(), system.matrix.scale * 2048);
  EXPECT_DOUBLE_EQ(scaling.displacement_limit(1), 32767.0 / 8);
  EXPECT_DOUBLE_EQ(scaling.displacement_limit(0), 32767.0 / 2);

  std::vector<std::int32_t> words(3);
  EXPECT_EQ(scaling.displacement_words(std::vector<double>{50, 32767.0 / 8, -10}, words), 0);
  EXPECT_EQ(words, (std::vector<std::int32_t>{100, 32767, -20}));
  std::vector<double> back(3);
  scaling.displacements(words, back);
  EXPECT_EQ(back, (std::vector<double>{50, 32767.0 / 8, -10}));
  EXPECT_EQ(scaling.displacement_words(std::vector<double>{0, 4100, 0}, words), 1);

  // b = A·x and S·b = (S·A·S)·y give the same words: y = (100, 200, -20) times the one of S·A·S.
  const double unit = scaling.force_unit();
  EXPECT_EQ(scaling.right_hand_side(std::vector<double>{4 * 50 * unit, 64 * 25 * unit, -40 * unit},
                                    words),
            0);
  EXPECT_EQ(words, (std::vector<std::int32_t>{100, 200, -20}));
}

TEST(Scaling, OfAnUnscaledSystemIsThatOfItsMatrix) {
  Settings s;
  s.static_scale = StaticScale::matrix_norm;
  s.static_shift = 5;
  const System system = prepare(diagonal_matrix(), s);
  ASSERT_NE(system.settings.static_shift, s.static_shift);
  const Scaling scaling(system);
  EXPECT_EQ(scaling.displacement_unit(), Scaling(s, system.matrix).displacement_unit());
  EXPECT_EQ(scaling.force_unit(), Scaling(system.settings, system.matrix).force_unit());
}

TEST(Scaling, RefusesAVectorOfAnotherSystem) {
  Settings s;
  s.matrix_scaling = MatrixScaling::diagonal;
  const Scaling scaling(prepare(diagonal_matrix(), s));
  std::vector<std::int32_t> words(6);
  EXPECT_THROW(scaling.right_hand_side(std::vector<double>(6), words), InputError);
  EXPECT_THROW(scaling.displacement_words(std::vector<double>(6), words), InputError);
  std::vector<double> back(6);
  EXPECT_THROW(scaling.displacements(words, back), InputError);
}

TEST(Settings, HeadroomMustLeaveAValue) {
  Settings s;
  s.vector_bits = 12;
  s.headroom_bits = 5;
  EXPECT_NO_THROW(s.check());
  s.headroom_bits = 6;
  EXPECT_THROW(s.check(), InputError);
}

}  // namespace
}  // namespace hvp::fixed::scaling_test
