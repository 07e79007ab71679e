#include "models/fixed/scaling.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::fixed {
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

TEST(Settings, HeadroomMustLeaveAValue) {
  Settings s;
  s.vector_bits = 12;
  s.headroom_bits = 5;
  EXPECT_NO_THROW(s.check());
  s.headroom_bits = 6;
  EXPECT_THROW(s.check(), InputError);
}

}  // namespace
}  // namespace hvp::fixed
