#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/hold.h"
#include "models/fem/structured_box.h"
#include "models/index.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::statics {

// Section 3 of the reference values, which another program's own Newton found and felupe 11.3
// confirmed to 1e-11.

enum class Problem { cantilever, block, cube };

// A body, the active nodes that are pushed or held, and what a parameter p does to them.
struct Scene {
  fem::Body body;
  std::vector<int> watched;  // active nodes

  std::vector<double> load;
  std::vector<Eigen::Vector3d> displacement;  // of the watched nodes; empty where they are loaded

  fem::Hold hold() const {
    if (displacement.empty()) return {};
    return {.nodes = watched, .displacement = displacement, .let_go = {}};
  }
};

inline fem::Body clamped_box(const Eigen::Vector3d& size, const std::array<int, 3>& cells,
                             int axis) {
  mesh::TetMesh mesh = fem::structured_box(size, cells);
  std::vector<int> clamped;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.nodes[n][axis] == 0) clamped.push_back(static_cast<int>(n));
  }
  return fem::Body(std::move(mesh), reference_material(), clamped, fem::AnchorTreatment::removed);
}

template <class Choice>
Scene scene_with(fem::Body body, const Choice& choice) {
  Scene scene{.body = std::move(body), .watched = {}, .load = {}, .displacement = {}};
  for (int a = 0; a < scene.body.active_nodes(); ++a) {
    if (choice(scene.body.mesh().nodes[at(scene.body.node_of_active()[at(a)])])) {
      scene.watched.push_back(a);
    }
  }
  scene.load.assign(scene.body.load().size(), 0.0);
  return scene;
}

// 50 × 10 × 10 mm, clamped at x = 0; a force of p N downwards, spread over the far face's nodes.
inline Scene cantilever(double p) {
  Scene scene = scene_with(clamped_box({0.05, 0.01, 0.01}, {10, 2, 2}, 0),
                           [](const Eigen::Vector3d& x) { return x.x() > 0.05 - 1e-9; });
  for (const int a : scene.watched) {
    scene.load[3 * at(a) + 2] = -p / static_cast<double>(scene.watched.size());
  }
  return scene;
}

// 60 × 60 × 30 mm, clamped below; the five nodes above within 5 mm of the centre held p m deeper.
inline Scene block(double p) {
  Scene scene =
      scene_with(clamped_box({0.06, 0.06, 0.03}, {12, 12, 6}, 2), [](const Eigen::Vector3d& x) {
        return (x - Eigen::Vector3d(0.03, 0.03, 0.03)).norm() < 0.005 + 1e-9 && x.z() > 0.0299;
      });
  scene.displacement.assign(scene.watched.size(), Eigen::Vector3d(0, 0, -p));
  return scene;
}

// A cube of 10 mm, clamped at x = 0, its far face turned by p about its own axis.
inline Scene cube(double p) {
  Scene scene = scene_with(clamped_box({0.01, 0.01, 0.01}, {3, 3, 3}, 0),
                           [](const Eigen::Vector3d& x) { return x.x() > 0.01 - 1e-9; });
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(p, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const Eigen::Vector3d centre(0.01, 0.005, 0.005);
  for (const int a : scene.watched) {
    const Eigen::Vector3d& x = scene.body.mesh().nodes[at(scene.body.node_of_active()[at(a)])];
    scene.displacement.emplace_back(turn * (x - centre) + centre - x);
  }
  return scene;
}

inline Scene make(Problem problem, double p) {
  if (problem == Problem::cantilever) return cantilever(p);
  return problem == Problem::block ? block(p) : cube(p);
}

struct Row {
  LawKind law;
  Problem problem;
  double p;
  double u_m[3];         // mean of the watched nodes
  double reaction_n[3];  // sum of what holds them
  double energy_j;
  double moment_nm;  // of the reactions about the line y = z = 5 mm, on the body at rest
  double smallest_determinant;
  double exponent = 1;  // b of Fung's law
};

inline constexpr Row kRows[] = {
    {LawKind::neo_hookean_log,
     Problem::cantilever,
     0.0001,
     {-1.614032352e-06, +4.315956865e-05, -1.584336114e-04},
     {0, 0, 0},
     7.922338117e-09,
     0,
     0.999},
    {LawKind::neo_hookean_log,
     Problem::cantilever,
     0.002,
     {-1.408338117e-04, +8.597492184e-04, -3.176820008e-03},
     {0, 0, 0},
     3.178561573e-06,
     0,
     0.990},
    {LawKind::neo_hookean_log,
     Problem::cantilever,
     0.008,
     {-1.865927204e-03, +3.183602505e-03, -1.245497320e-02},
     {0, 0, 0},
     4.921399449e-05,
     0,
     0.960},
    {LawKind::neo_hookean_log,
     Problem::block,
     0.001,
     {0, 0, -1.000000000e-03},
     {+1.316429395e-02, +1.316429395e-02, -2.165504609e-01},
     1.076416501e-04,
     -5.731395788e-03,
     0.950},
    {LawKind::neo_hookean_log,
     Problem::block,
     0.003,
     {0, 0, -3.000000000e-03},
     {+4.596121094e-02, +4.596121094e-02, -6.735107583e-01},
     9.921669339e-04,
     -1.794910592e-02,
     0.858},
    {LawKind::neo_hookean_log,
     Problem::block,
     0.006,
     {0, 0, -6.000000000e-03},
     {+1.116899862e-01, +1.116899862e-01, -1.431558864e+00},
     4.124573591e-03,
     -3.848783346e-02,
     0.731},
    {LawKind::neo_hookean_log,
     Problem::block,
     0.009,
     {0, 0, -9.000000000e-03},
     {+1.933002298e-01, +1.933002298e-01, -2.317870262e+00},
     9.709013487e-03,
     -6.260467963e-02,
     0.611},
    {LawKind::neo_hookean_log,
     Problem::cube,
     M_PI / 6,
     {0, 0, 0},
     {-1.071689112e-02, +1.372453967e-04, +2.377160002e-04},
     1.133611131e-04,
     +3.736794617e-04,
     0.973},
    {LawKind::neo_hookean_isochoric,
     Problem::cantilever,
     0.0001,
     {-1.613975786e-06, +4.316030741e-05, -1.584336322e-04},
     {0, 0, 0},
     7.922340206e-09,
     0,
     0.999},
    {LawKind::neo_hookean_isochoric,
     Problem::cantilever,
     0.002,
     {-1.408525030e-04, +8.602049878e-04, -3.177464686e-03},
     {0, 0, 0},
     3.179532026e-06,
     0,
     0.990},
    {LawKind::neo_hookean_isochoric,
     Problem::cantilever,
     0.008,
     {-1.875532001e-03, +3.194270628e-03, -1.249125278e-02},
     {0, 0, 0},
     4.942753433e-05,
     0,
     0.958},
    {LawKind::neo_hookean_isochoric,
     Problem::block,
     0.001,
     {0, 0, -1.000000000e-03},
     {+1.300323325e-02, +1.300323325e-02, -2.164443486e-01},
     1.076071597e-04,
     -5.726441218e-03,
     0.950},
    {LawKind::neo_hookean_isochoric,
     Problem::block,
     0.003,
     {0, 0, -3.000000000e-03},
     {+4.449630757e-02, +4.449630757e-02, -6.721575612e-01},
     9.909930176e-04,
     -1.789500141e-02,
     0.851},
    {LawKind::neo_hookean_isochoric,
     Problem::block,
     0.006,
     {0, 0, -6.000000000e-03},
     {+1.061977524e-01, +1.061977524e-01, -1.419793394e+00},
     4.108020582e-03,
     -3.812756368e-02,
     0.706},
    {LawKind::neo_hookean_isochoric,
     Problem::block,
     0.009,
     {0, 0, -9.000000000e-03},
     {+1.824453033e-01, +1.824453033e-01, -2.262855799e+00},
     9.604906945e-03,
     -6.113727054e-02,
     0.554},
    {LawKind::neo_hookean_isochoric,
     Problem::cube,
     M_PI / 6,
     {0, 0, 0},
     {-1.271589620e-02, +2.455191757e-04, +4.252516866e-04},
     1.136253653e-04,
     +3.683348716e-04,
     0.975},
    {LawKind::st_venant_kirchhoff,
     Problem::cantilever,
     0.0001,
     {-1.643977975e-06, +4.314989718e-05, -1.583497486e-04},
     {0, 0, 0},
     7.916745622e-09,
     0,
     0.999},
    {LawKind::st_venant_kirchhoff,
     Problem::cantilever,
     0.002,
     {-1.506377064e-04, +8.559983071e-04, -3.142084997e-03},
     {0, 0, 0},
     3.132071301e-06,
     0,
     0.990},
    {LawKind::st_venant_kirchhoff,
     Problem::cantilever,
     0.008,
     {-1.913227568e-03, +3.151874376e-03, -1.190996896e-02},
     {0, 0, 0},
     4.633910222e-05,
     0,
     0.956},
    {LawKind::st_venant_kirchhoff,
     Problem::block,
     0.001,
     {0, 0, -1.000000000e-03},
     {+1.266407135e-02, +1.266407135e-02, -1.900942078e-01},
     9.878138186e-05,
     -5.049538127e-03,
     0.948},
    {LawKind::st_venant_kirchhoff,
     Problem::cube,
     M_PI / 6,
     {0, 0, 0},
     {+2.731642177e-02, -2.509483712e-03, -4.346553290e-03},
     1.197166047e-04,
     +5.375015758e-04,
     0.943},
    // Not felupe's: of a program that has the rows of the isochoric neo-Hookean law for b = 0, and
    // the derivatives of Fung's stress by complex steps.
    {LawKind::fung,
     Problem::cantilever,
     0.0001,
     {-1.613973109e-06, +4.316004740e-05, -1.584331256e-04},
     {0, 0, 0},
     7.922302203e-09,
     0,
     0.999,
     6},
    {LawKind::fung,
     Problem::cantilever,
     0.002,
     {-1.405610246e-04, +8.581416909e-04, -3.173307700e-03},
     {0, 0, 0},
     3.173287189e-06,
     0,
     0.990,
     6},
    {LawKind::fung,
     Problem::cantilever,
     0.008,
     {-1.805998880e-03, +3.087786274e-03, -1.223096024e-02},
     {0, 0, 0},
     4.787613393e-05,
     0,
     0.959,
     6},
    {LawKind::fung,
     Problem::block,
     0.001,
     {0, 0, -1.000000000e-03},
     {+1.279369888e-02, +1.279369888e-02, -2.226631883e-01},
     1.091667909e-04,
     -5.879411940e-03,
     0.950,
     6},
    {LawKind::fung,
     Problem::block,
     0.003,
     {0, 0, -3.000000000e-03},
     {+4.113083278e-02, +4.113083278e-02, -8.306311701e-01},
     1.112016957e-03,
     -2.184171868e-02,
     0.854,
     6},
    {LawKind::fung,
     Problem::block,
     0.006,
     {0, 0, -6.000000000e-03},
     {+1.023341363e-01, +1.023341363e-01, -2.700366089e+00},
     5.994716576e-03,
     -7.047490942e-02,
     0.705,
     6},
    {LawKind::fung,
     Problem::cube,
     M_PI / 6,
     {0, 0, 0},
     {-1.974071802e-02, +4.945479990e-04, +8.565822610e-04},
     1.519548509e-04,
     +6.531906110e-04,
     0.969,
     6},
};

}  // namespace hvp::tissue::statics
