// What diagonal scaling before rounding is worth on meshes of our own: how far a perfect solver
// ends from the true model, pressed at the highest node. The figures are in the report's
// properties.
#include <algorithm>
#include <array>
#include <optional>

#include <gtest/gtest.h>

#include "models/fem/body.h"
#include "models/fem/newmark.h"
#include "models/fixed/system.h"
#include "models/host/deviation.h"
#include "models/host/reference_run.h"
#include "models/mesh/generate.h"
#include "models/mesh/region.h"

namespace hvp::host::diagonal_scaling_test {
namespace {

constexpr double kPeriod = 2e-3;

fem::Body make_body(mesh::MeshSettings::Shape shape, int nodes, double poisson_ratio) {
  mesh::MeshSettings settings;
  settings.shape = shape;
  settings.nodes = nodes;
  mesh::TetMesh mesh = mesh::generate(settings);
  const std::vector<int> anchored = mesh::select_nodes({}, mesh);
  fem::Material material;
  material.poisson_ratio = poisson_ratio;
  return {std::move(mesh), material, anchored, fem::AnchorTreatment::removed};
}

// Of the displacement in a static press, exact solutions of the rounded and of the true matrix.
double rounding_error(const fem::Body& body, fixed::MatrixScaling scaling) {
  fixed::Settings settings;
  settings.matrix_scaling = scaling;
  const sparse::BlockMatrix& k = body.stiffness();
  const sparse::BlockMatrix rounded = fixed::dequantise(fixed::prepare(k, settings));
  ReferenceRun truth(body, std::nullopt, kPeriod, k, k);
  ReferenceRun words(body, std::nullopt, kPeriod, k, rounded);
  const auto& nodes = body.mesh().nodes;
  const auto top = std::max_element(nodes.begin(), nodes.end(),
                                    [](const auto& a, const auto& b) { return a.z() < b.z(); });
  const std::vector<int> contact = {body.active_index(static_cast<int>(top - nodes.begin()))};
  const std::array<Eigen::Vector3d, 1> held = {Eigen::Vector3d(0, 0, -5e-3)};
  truth.step({contact, held, {}, 0});
  words.step({contact, held, {}, 0});
  Deviation deviation;
  deviation.add(words.displacement(), truth.displacement());
  return *deviation.relative();
}

// An independent computation at κ ≈ 3000: 4e-2 comes to 1e-2.
TEST(DiagonalScaling, TakesMostOfTheMatrixRoundingAway) {
  using Shape = mesh::MeshSettings::Shape;
  struct Case {
    Shape shape;
    int nodes;
    double poisson_ratio;
  };
  for (const Case& c : {Case{Shape::sphere, 500, 0.25}, Case{Shape::sphere, 500, 0.45},
                        Case{Shape::box, 500, 0.45}, Case{Shape::box, 1000, 0.25}}) {
    const fem::Body body = make_body(c.shape, c.nodes, c.poisson_ratio);
    const double plain = rounding_error(body, fixed::MatrixScaling::none);
    const double scaled = rounding_error(body, fixed::MatrixScaling::diagonal);
    RecordProperty((c.shape == Shape::box ? "box_" : "sphere_") + std::to_string(c.nodes) + "_nu_" +
                       std::to_string(c.poisson_ratio),
                   std::to_string(plain) + " " + std::to_string(scaled));
    EXPECT_LT(scaled, plain / 2);
    EXPECT_LT(scaled, 0.03);
  }
}

}  // namespace
}  // namespace hvp::host::diagonal_scaling_test
