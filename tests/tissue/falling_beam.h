#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/fem/loads.h"
#include "models/tissue/central_differences.h"
#include "tests/tissue/static_problems.h"

namespace hvp::tissue {

// Scene T of the reference values: a beam of 40 × 10 × 10 mm in cells of 5 mm, clamped at x = 0,
// on which 9.81 m/s² begins to act at time zero.
inline fem::Body falling_beam() { return statics::clamped_box({0.04, 0.01, 0.01}, {8, 2, 2}, 0); }

// Over active nodes, N.
inline std::vector<double> its_weight(const fem::Body& body) {
  fem::Loads loads;
  loads.gravity = fem::Gravity{.acceleration = {0, 0, -9.81}};
  const std::vector<double> all = fem::assemble_loads(body.mesh(), body.material(), loads);
  std::vector<double> active;
  for (const int node : body.node_of_active()) {
    for (std::size_t i = 0; i < 3; ++i) active.push_back(all[3 * at(node) + i]);
  }
  return active;
}

// The displacement of the beam's last node, the far upper corner.
inline Eigen::Vector3d tip(const CentralDifferences& dynamics) {
  const std::span<const double> u = dynamics.displacement();
  return Eigen::Vector3d(u[u.size() - 3], u[u.size() - 2], u[u.size() - 1]);
}

struct BeamRow {
  LawKind law;
  int step;
  double u_m[3];
  double kinetic_j;
  double strain_j;
  double total_j;
};

// Section 5 of the reference values, another program's, with substeps of 0.1 ms.
inline constexpr BeamRow kBeamRows[] = {
    {LawKind::linear,
     1,
     {+0.000000000000e+00, +0.000000000000e+00, -4.905000000000e-08},
     1.804260995e-09,
     8.296215517e-14,
     -8.291746e-14},
    {LawKind::linear,
     2,
     {+0.000000000000e+00, -1.557761742077e-26, -1.962000000000e-07},
     7.215718725e-09,
     1.325966616e-12,
     -3.309596e-13},
    {LawKind::linear,
     10,
     {-4.138771544561e-23, -8.959472736183e-23, -4.905000000000e-06},
     1.793603660e-07,
     8.026106473e-10,
     -7.782671e-12},
    {LawKind::linear,
     100,
     {+4.226367506068e-06, +4.934908656384e-11, -4.916113285076e-04},
     1.394779075e-05,
     2.291420039e-06,
     -1.455165e-10},
    {LawKind::linear,
     500,
     {+1.602104915187e-03, +9.235615669196e-04, -1.418370440925e-02},
     1.055655347e-04,
     1.328196915e-04,
     -3.401983e-10},
    {LawKind::linear,
     1000,
     {+2.183245356354e-03, +7.266828161838e-03, -2.514180307592e-02},
     1.793743747e-05,
     4.043259414e-04,
     -1.206959e-10},
    {LawKind::corotational,
     1,
     {+0.000000000000e+00, +0.000000000000e+00, -4.905000000000e-08},
     1.804260995e-09,
     8.296215518e-14,
     -8.291746e-14},
    {LawKind::corotational,
     2,
     {+0.000000000000e+00, -3.115523484154e-26, -1.962000000000e-07},
     7.215718725e-09,
     1.325966618e-12,
     -3.309596e-13},
    {LawKind::corotational,
     10,
     {-1.966113137897e-19, +8.258405520875e-20, -4.905000000000e-06},
     1.793603635e-07,
     8.026128726e-10,
     -7.782783e-12},
    {LawKind::corotational,
     100,
     {+4.299287208941e-06, -9.543478111876e-09, -4.916206913142e-04},
     1.394787925e-05,
     2.290566414e-06,
     -1.455673e-10},
    {LawKind::corotational,
     500,
     {-5.195677426676e-04, +9.180420107219e-04, -1.424748546147e-02},
     1.053293874e-04,
     1.314353821e-04,
     -3.297115e-10},
    {LawKind::corotational,
     1000,
     {-7.251118438624e-03, +7.288607435058e-03, -2.490721174677e-02},
     1.327607045e-05,
     3.966471345e-04,
     -1.467707e-10},
    {LawKind::st_venant_kirchhoff,
     1,
     {+0.000000000000e+00, +0.000000000000e+00, -4.905000000000e-08},
     1.804260995e-09,
     8.296215519e-14,
     -8.291746e-14},
    {LawKind::st_venant_kirchhoff,
     2,
     {-2.636841783943e-62, -1.557761742077e-26, -1.962000000000e-07},
     7.215718725e-09,
     1.325966622e-12,
     -3.309596e-13},
    {LawKind::st_venant_kirchhoff,
     10,
     {-4.138782133312e-23, -8.959432810607e-23, -4.905000000000e-06},
     1.793603587e-07,
     8.026172248e-10,
     -7.782996e-12},
    {LawKind::st_venant_kirchhoff,
     100,
     {+4.373050489044e-06, -2.195947251330e-08, -4.916336575111e-04},
     1.393583031e-05,
     2.298385713e-06,
     -1.469882e-10},
    {LawKind::st_venant_kirchhoff,
     500,
     {-7.390807458410e-04, +9.478146629162e-04, -1.405659682368e-02},
     9.953921056e-05,
     1.328346282e-04,
     -3.274408e-10},
    {LawKind::st_venant_kirchhoff,
     1000,
     {-8.198031274871e-03, +7.992027552531e-03, -2.387611590006e-02},
     1.348772741e-05,
     3.706193700e-04,
     -1.379387e-10},
    {LawKind::neo_hookean_log,
     1,
     {+0.000000000000e+00, +0.000000000000e+00, -4.905000000000e-08},
     1.804260995e-09,
     8.296198977e-14,
     -8.291762e-14},
    {LawKind::neo_hookean_log,
     2,
     {+0.000000000000e+00, -1.557761742077e-26, -1.962000000000e-07},
     7.215718725e-09,
     1.325966521e-12,
     -3.309597e-13},
    {LawKind::neo_hookean_log,
     10,
     {-4.138475384667e-23, -9.170928082679e-23, -4.905000000000e-06},
     1.793603668e-07,
     8.026099145e-10,
     -7.782633e-12},
    {LawKind::neo_hookean_log,
     100,
     {+4.239998228863e-06, +1.054629704268e-09, -4.916109187049e-04},
     1.395691611e-05,
     2.284597124e-06,
     -1.444809e-10},
    {LawKind::neo_hookean_log,
     500,
     {-3.541592085825e-04, +8.901267297678e-04, -1.441232228645e-02},
     1.118465428e-04,
     1.287927110e-04,
     -3.157503e-10},
    {LawKind::neo_hookean_log,
     1000,
     {-7.461197795412e-03, +6.530839104305e-03, -2.732954162312e-02},
     1.097692861e-05,
     4.472261413e-04,
     -1.571479e-10},
    {LawKind::neo_hookean_isochoric,
     1,
     {+0.000000000000e+00, +0.000000000000e+00, -4.905000000000e-08},
     1.804260995e-09,
     8.296198977e-14,
     -8.291762e-14},
    {LawKind::neo_hookean_isochoric,
     2,
     {+0.000000000000e+00, -1.557761742077e-26, -1.962000000000e-07},
     7.215718725e-09,
     1.325966517e-12,
     -3.309597e-13},
    {LawKind::neo_hookean_isochoric,
     10,
     {-4.191919795935e-23, -9.394945936989e-23, -4.905000000000e-06},
     1.793603671e-07,
     8.026095678e-10,
     -7.782615e-12},
    {LawKind::neo_hookean_isochoric,
     100,
     {+4.230606503488e-06, +1.986081130650e-09, -4.916094511098e-04},
     1.395762584e-05,
     2.284206382e-06,
     -1.444150e-10},
    {LawKind::neo_hookean_isochoric,
     500,
     {-3.542983703748e-04, +8.907871248351e-04, -1.442219587703e-02},
     1.124397645e-04,
     1.284004784e-04,
     -3.123064e-10},
    {LawKind::neo_hookean_isochoric,
     1000,
     {-7.590457497471e-03, +6.469769129037e-03, -2.764508580575e-02},
     1.196590647e-05,
     4.523773124e-04,
     -1.640602e-10},
};

}  // namespace hvp::tissue
