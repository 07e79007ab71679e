// A word that only one of both engines has is found, in every memory and every copy of d, and named
// with its place and both values.
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/vp/engine/random_systems.h"
#include "tests/vp/engine/rtl_pair.h"

namespace hvp::vp::rtl::rtl_difference_test {
namespace {

using test::Random;
using test::settings_of;
using ::testing::HasSubstr;

constexpr int kNode = 17;
constexpr int kComponent = 1;

// Solves of one system by the cycle-accurate engine, each beside an RTL engine of its own.
class Injections {
 public:
  Injections() {
    settings.iterations = 6;
    settings.start = fixed::Start::extrapolated;
    engine.load(matrix, settings);
    engine.write_b(b);
  }

  // Changes the RTL engine before a solve, or behind its last iteration, and returns the difference
  // that is found.
  using Change = std::function<void(EngineMemories&)>;
  std::string difference(const Change& before, const Change& behind) {
    RtlComparison both(engine, kEngineThesis);
    both.load(matrix, settings);
    engine.load(matrix, settings);
    both.rtl().write_b(b);
    engine.write_b(b);
    both.write_x(x);
    engine.write_x(x);
    sc_core::sc_start();  // x is in the copies of d
    if (before) before(both.rtl().memories());
    both.start_solve(settings);
    engine.start_solve(settings, &both);
    sc_core::sc_start();
    if (behind) behind(both.rtl().memories());
    both.end_solve();
    return both.difference();
  }

  Random random{8};
  fixed::Settings settings = settings_of(kEngineThesis);
  fixed::QuantisedMatrix matrix = hvp::test::random_matrix(30, 8, 12, random);
  std::vector<std::int32_t> b = hvp::test::random_words(matrix.rows(), 30000, 7);
  std::vector<std::int32_t> x = hvp::test::random_words(matrix.rows(), 300, 9);
  engine::CycleEngine engine{"engine", test::architecture_of(kEngineThesis)};
};

// Inverts a bit and notes the words before and after.
Injections::Change flip(Vector vector, int copy, std::int32_t& was, std::int32_t& is) {
  return [=, &was, &is](EngineMemories& memories) {
    was = memories.word(vector, kNode, kComponent, copy);
    is = was ^ 4;
    memories.set_word(vector, kNode, kComponent, is, copy);
  };
}

std::string named(const std::string& what, std::int32_t rtl, std::int32_t model) {
  return what + " is " + std::to_string(rtl) + " in RTL and " + std::to_string(model) +
         " in the cycle-accurate engine at clock ";
}

TEST(RtlDifference, NothingIsFoundWhereNothingIsChanged) {
  Injections injections;
  EXPECT_EQ(injections.difference({}, {}), "");
}

TEST(RtlDifference, AWordOfAnyVectorIsFoundBehindTheJob) {
  Injections injections;
  for (const Vector v : {Vector::x, Vector::r, Vector::b, Vector::q, Vector::previous}) {
    SCOPED_TRACE(name(v));
    std::int32_t was = 0, is = 0;
    const std::string found = injections.difference({}, flip(v, 0, was, is));
    const std::string what = std::string(name(v)) + ", component 1 of node 17,";
    EXPECT_THAT(found, HasSubstr(named(what, is, was)));
    EXPECT_THAT(found, HasSubstr(" of solve 1, iteration 6"));
    // The model has the word that was there.
    EXPECT_NE(was, is);
  }
}

TEST(RtlDifference, AWordOfAnyCopyOfDIsFoundBeforeTheJob) {
  Injections injections;
  for (int copy = 0; copy < kEngineThesis.partitions; ++copy) {
    SCOPED_TRACE(copy);
    std::int32_t was = 0, is = 0;
    const std::string found = injections.difference(flip(Vector::d, copy, was, is), {});
    const std::string what =
        "d in the copy of partition " + std::to_string(copy) + ", component 1 of node 17,";
    EXPECT_THAT(found, HasSubstr(named(what, is, was) + "0 of solve 1, iteration 0"));
  }
}

TEST(RtlDifference, AnEntryOfTheMatrixIsFound) {
  Injections injections;
  for (int partition = 0; partition < kEngineThesis.partitions; ++partition) {
    SCOPED_TRACE(partition);
    std::int32_t was = 0;
    const std::string found = injections.difference(
        [&](EngineMemories& memories) {
          was = memories.entry(partition, 3, 2, 5);
          memories.set_entry(partition, 3, 2, 5, was ^ 64);
          EXPECT_EQ(memories.entry(partition, 3, 2, 4),
                    injections.engine.block(partition).package_words(3)[20]);
        },
        {});
    const std::string what =
        "the matrix in row 2 and column 5 of package 3 of partition " + std::to_string(partition);
    EXPECT_THAT(found, HasSubstr(named(what, was ^ 64, was)));
    EXPECT_THAT(found, HasSubstr(" of solve 1, iteration 1"));
  }
}

// Between two iterations a flip shows in what is made of it.
TEST(RtlDifference, AWordThatChangesInAnIterationIsFoundInTheNext) {
  struct Flipping : fixed::Observer {
    Flipping(RtlComparison& comparison, Vector which) : both(comparison), vector(which) {}
    void iteration(const fixed::IterationState& state) override {
      if (state.iteration == 3) {
        EngineMemories& memories = both.rtl().memories();
        memories.set_word(vector, kNode, kComponent,
                          memories.word(vector, kNode, kComponent) ^ 1024);
      }
      both.iteration(state);
    }
    RtlComparison& both;
    Vector vector;
  };
  Injections injections;
  const std::pair<Vector, const char*> shown[] = {{Vector::d, "q"},
                                                  {Vector::r, "r, component 1 of node 17,"},
                                                  {Vector::x, "x, component 1 of node 17,"},
                                                  {Vector::b, "b, component 1 of node 17,"}};
  for (const auto& [vector, first] : shown) {
    SCOPED_TRACE(name(vector));
    RtlComparison both(injections.engine, kEngineThesis);
    Flipping flipping(both, vector);
    both.load(injections.matrix, injections.settings);
    injections.engine.load(injections.matrix, injections.settings);
    both.rtl().write_b(injections.b);
    injections.engine.write_b(injections.b);
    both.write_x(injections.x);
    injections.engine.write_x(injections.x);
    both.start_solve(injections.settings);
    injections.engine.start_solve(injections.settings, &flipping);
    sc_core::sc_start();
    EXPECT_THAT(both.difference(), testing::StartsWith(first));
    EXPECT_THAT(both.difference(), HasSubstr(" of solve 1, iteration 3"));
  }
}

}  // namespace
}  // namespace hvp::vp::rtl::rtl_difference_test
