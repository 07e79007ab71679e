#include "models/mesh/generate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "models/mesh/quality.h"

namespace hvp::mesh {
namespace {

TEST(Generate, ThesisSphereHasNearly500Nodes) {
  const Quality quality = measure(generate(MeshSettings{}));
  EXPECT_LE(std::abs(static_cast<int>(quality.nodes) - 500), 5);
}

}  // namespace
}  // namespace hvp::mesh
