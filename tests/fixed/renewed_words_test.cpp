// Words of another matrix at the scale of the first: room for it, and what is beyond.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "models/fem/body.h"
#include "models/fem/structured_box.h"
#include "models/fixed/remedy.h"
#include "models/fixed/system.h"
#include "models/fixed/word.h"
#include "models/index.h"

namespace hvp::fixed::renewed_words_test {
namespace {

sparse::BlockMatrix stiffness() {
  mesh::TetMesh mesh = fem::structured_box({0.02, 0.02, 0.02}, {2, 2, 2});
  std::vector<int> clamped;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n].z() == 0) clamped.push_back(static_cast<int>(n));
  }
  return fem::Body(std::move(mesh), {}, clamped, fem::AnchorTreatment::removed).stiffness();
}

sparse::BlockMatrix times(sparse::BlockMatrix matrix, double factor) {
  for (double& entry : matrix.value) entry *= factor;
  return matrix;
}

std::int32_t largest(const QuantisedMatrix& matrix) {
  std::int32_t most = 0;
  for (const std::int32_t word : matrix.value) most = std::max(most, std::abs(word));
  return most;
}

TEST(RenewedWords, HeadroomLeavesRoomAndNoneChangesNothing) {
  const sparse::BlockMatrix k = stiffness();
  const System plain = prepare(k, {});
  EXPECT_EQ(largest(plain.matrix), word_limit(12));
  EXPECT_EQ(prepare(k, {}, 1).matrix.value, plain.matrix.value);
  EXPECT_EQ(prepare(k, {}, 1).matrix.scale, plain.matrix.scale);
  const System roomy = prepare(k, {}, 1.6);
  EXPECT_EQ(largest(roomy.matrix), std::lround(word_limit(12) / 1.6));
  EXPECT_DOUBLE_EQ(roomy.matrix.scale, 1.6 * plain.matrix.scale);
}

// The static shift of a matrix that may grow is that of the grown one.
TEST(RenewedWords, TheStaticShiftHoldsForTheGrownRows) {
  Settings settings;
  settings.static_scale = StaticScale::matrix_norm;
  const sparse::BlockMatrix k = stiffness();
  for (const double growth : {1.0, 1.3, 1.9, 4.0}) {
    System system = prepare(k, settings, growth);
    const int shift = system.settings.static_shift;
    ASSERT_EQ(replace_values(times(k, growth), system).beyond, 0);
    EXPECT_GE(shift, static_shift_for(system.matrix)) << growth;
    EXPECT_LE(shift, static_shift_for(system.matrix) + 1) << growth;
  }
}

TEST(RenewedWords, AreThoseOfTheMatrixAtTheScaleThatStays) {
  for (const MatrixScaling scaling : {MatrixScaling::none, MatrixScaling::diagonal}) {
    Settings settings;
    settings.matrix_scaling = scaling;
    const sparse::BlockMatrix k = stiffness();
    System system = prepare(k, settings, 2);
    const System before = system;
    // The same matrix is the same words.
    const Fit same = replace_values(k, system);
    EXPECT_EQ(same.beyond, 0);
    EXPECT_NEAR(same.filling, 0.5, 1e-12);
    EXPECT_EQ(system.matrix.value, before.matrix.value);
    // One that has grown fills them.
    const Fit grown = replace_values(times(k, 1.9), system);
    EXPECT_EQ(grown.beyond, 0);
    EXPECT_NEAR(grown.filling, 0.95, 1e-12);
    EXPECT_EQ(system.matrix.scale, before.matrix.scale);
    for (std::size_t i = 0; i < system.matrix.value.size(); ++i) {
      ASSERT_NEAR(system.matrix.value[i], 1.9 * before.matrix.value[i], 1.5) << i;
    }
  }
}

TEST(RenewedWords, BeyondTheScaleNoneIsTaken) {
  const sparse::BlockMatrix k = stiffness();
  System system = prepare(k, {}, 1.25);
  const System before = system;
  const Fit fit = replace_values(times(k, 1.5), system);
  EXPECT_GT(fit.beyond, 0);
  EXPECT_NEAR(fit.filling, 1.5 / 1.25, 1e-12);
  EXPECT_EQ(system.matrix.value, before.matrix.value);

  sparse::BlockMatrix broken = k;
  broken.value[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(replace_values(broken, system).beyond, 1);
  EXPECT_EQ(system.matrix.value, before.matrix.value);
}

TEST(RenewedWords, TheRemedyForTooFewIsMoreHeadroom) {
  stability::Flags flags;
  flags.raise(stability::Flag::matrix_word_beyond_scale);
  flags.raise(stability::Flag::not_converged);
  Plan plan;
  plan.headroom = 1.25;
  const std::optional<Remedy> remedy = next_remedy(flags, plan);
  ASSERT_TRUE(remedy);
  EXPECT_EQ(remedy->flag, stability::Flag::matrix_word_beyond_scale);
  EXPECT_EQ(remedy->change, "object.model.matrix.headroom = 2.5");
  // A matrix that stays has none.
  plan.headroom = 0;
  const std::optional<Remedy> other = next_remedy(flags, plan);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->flag, stability::Flag::not_converged);
}

}  // namespace
}  // namespace hvp::fixed::renewed_words_test
