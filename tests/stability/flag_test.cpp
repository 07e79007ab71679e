#include "models/stability/flag.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace hvp::stability::flag_test {
namespace {

TEST(Flag, EachHasANameOfItsOwnAMeaningAndARemedy) {
  std::set<std::string> names;
  for (unsigned i = 0; i < static_cast<unsigned>(Flag::count); ++i) {
    const Description& d = describe(static_cast<Flag>(i));
    EXPECT_TRUE(names.insert(std::string(d.name)).second) << d.name;
    EXPECT_FALSE(d.meaning.empty()) << d.name;
    EXPECT_FALSE(d.remedy.empty()) << d.name;
  }
}

TEST(Flags, AreASetThatFitsARegister) {
  Flags flags;
  EXPECT_TRUE(flags.empty());
  flags.raise(Flag::stagnation);
  flags.raise(Flag::stagnation);
  EXPECT_TRUE(flags.has(Flag::stagnation));
  EXPECT_FALSE(flags.has(Flag::saturation));
  Flags others;
  others.raise(Flag::saturation);
  flags.merge(others);
  EXPECT_EQ(flags, Flags(flags.bits()));
  EXPECT_TRUE(flags.has(Flag::saturation));
  EXPECT_LE(static_cast<unsigned>(Flag::count), 32U);
  // The board's STATUS register has room for the low sixteen: what a solver raises is among them.
  for (const Flag flag :
       {Flag::saturation, Flag::negative_curvature, Flag::zero_diagonal, Flag::stagnation,
        Flag::scalar_overflow, Flag::divergence, Flag::wrapped}) {
    EXPECT_LT(static_cast<unsigned>(flag), 16U);
  }
}

}  // namespace
}  // namespace hvp::stability::flag_test
