#include "models/tissue/explicit_tissue.h"

#include <memory>

#include <gtest/gtest.h>

#include "models/tissue/elastic_body.h"
#include "models/tissue/springs.h"
#include "tests/tissue/static_problems.h"

namespace hvp::tissue::explicit_tissue_test {
namespace {

using namespace statics;

// What `hvp explain` prices is what a frame at rest takes: the substeps' forces and updates, and
// the look at the limit.
TEST(ExplicitTissue, SaysWhatAFrameTakes) {
  const Scene scene = block(0);
  fem::Dynamics dynamics;
  dynamics.rayleigh_stiffness = 0;
  const auto expect_priced = [&](std::unique_ptr<PotentialBody> body) {
    ExplicitTissue tissue(std::move(body), fem::ContactDiagonal::average, dynamics, 2e-3, 0);
    tissue.hold({});
    EXPECT_EQ(tissue.step().operations, tissue.step_operations());
    EXPECT_FALSE(tissue.scheme());
  };
  expect_priced(std::make_unique<ElasticBody>(scene.body, LawKind::neo_hookean_log));
  expect_priced(std::make_unique<ElasticBody>(scene.body, LawKind::linear));
  expect_priced(std::make_unique<SpringBody>(scene.body));
}

}  // namespace
}  // namespace hvp::tissue::explicit_tissue_test
