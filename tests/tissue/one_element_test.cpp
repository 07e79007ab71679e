#include <Eigen/Core>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/algebra.h"
#include "tests/tissue/one_tetrahedron.h"

// Section 2 of the reference values: one tetrahedron, turned (u1), deformed (u3), deformed and
// turned (u2), and turned inside out (u4).

namespace hvp::tissue::one_element_test {
namespace {

using enum LawKind;

enum class State { u1, u2, u3, u4 };

Eigen::Matrix3d gradient_of(State state) {
  switch (state) {
    case State::u1:
      return reference_rotation();
    case State::u2:
      return reference_rotation() * reference_deformation();
    case State::u3:
      return reference_deformation();
    case State::u4:
      break;
  }
  return Eigen::Vector3d(1, 1, -0.5).asDiagonal();
}

struct Row {
  LawKind law;
  State state;
  double energy_j;
  double force_n[4][3];
};

constexpr Row kRows[] = {
    {linear,
     State::u1,
     1.056005725187e-03,
     {{+2.856232733385e-01, +2.427753831703e-01, +1.629744871077e-01},
      {-2.964745528472e-01, +6.399322131888e-02, +9.188394243449e-02},
      {+2.932778245595e-03, -3.226056070154e-01, +9.091612561344e-02},
      {+7.918501263106e-03, +1.583700252621e-02, -3.457745551556e-01}}},
    {linear,
     State::u2,
     1.820211311654e-03,
     {{+3.745459217095e-01, +3.163413884068e-01, +2.305634053286e-01},
      {-3.838787716694e-01, +8.214157262981e-02, +1.229643635291e-01},
      {+3.480785328402e-03, -4.170643540302e-01, +1.222438116663e-01},
      {+5.852064631485e-03, +1.858139299363e-02, -4.757715805240e-01}}},
    {linear,
     State::u3,
     2.142768598340e-05,
     {{-5.850335249042e-03, -6.198435504470e-03, +1.251133461047e-02},
      {+8.707136015326e-03, -2.708014048531e-03, +3.323595146871e-03},
      {-1.154214559387e-03, +1.343231162197e-02, -6.481481481482e-04},
      {-1.702586206897e-03, -4.525862068966e-03, -1.518678160920e-02}}},
    {linear,
     State::u4,
     5.120689655172e-03,
     {{+5.586206896552e-01, +4.965517241379e-01, +4.456896551724e-01},
      {-5.586206896552e-01, +1.241379310345e-01, +2.181034482759e-01},
      {+0.000000000000e+00, -6.206896551724e-01, +1.896551724138e-01},
      {+0.000000000000e+00, +0.000000000000e+00, -8.534482758621e-01}}},
    {corotational,
     State::u2,
     2.303968563655e-05,
     {{+2.994423241500e-03, -1.921012442254e-02, +5.528819846017e-03},
      {+1.288281956425e-02, +9.069300719015e-03, -7.067920409799e-03},
      {-1.600894515642e-02, +1.514602693881e-02, +7.450912823190e-03},
      {+1.317023506721e-04, -5.005203235289e-03, -5.911812259408e-03}}},
    {corotational,
     State::u3,
     2.303968563655e-05,
     {{-1.261868238932e-02, -1.401665254702e-02, +7.270873805944e-03},
      {+1.699588548829e-02, -3.029064005343e-03, -3.733659015754e-04},
      {-3.103772357489e-03, +2.296339896586e-02, -2.062392794487e-03},
      {-1.273430741485e-03, -5.917682413499e-03, -4.835115109882e-03}}},
    {corotational,
     State::u4,
     5.120689655172e-03,
     {{+5.586206896552e-01, +4.965517241379e-01, +4.456896551724e-01},
      {-5.586206896552e-01, +1.241379310345e-01, +2.181034482759e-01},
      {+0.000000000000e+00, -6.206896551724e-01, +1.896551724138e-01},
      {+0.000000000000e+00, +0.000000000000e+00, -8.534482758621e-01}}},
    {st_venant_kirchhoff,
     State::u2,
     2.589200416583e-05,
     {{-1.010622104829e-03, -3.472390252145e-02, -4.144122615160e-04},
      {+2.030403537838e-02, +1.560941332202e-02, -1.554621948193e-02},
      {-2.742790906063e-02, +2.593646155849e-02, +1.221517522054e-02},
      {+8.134495787086e-03, -6.821972359051e-03, +3.745456522906e-03}}},
    {st_venant_kirchhoff,
     State::u3,
     2.589200416583e-05,
     {{-2.363689626778e-02, -2.544317288554e-02, +9.405260355246e-04},
      {+2.912881509671e-02, -5.370837959072e-03, -4.500978533980e-03},
      {-5.143081932536e-03, +3.913624449803e-02, -4.012955781857e-03},
      {-3.488368963937e-04, -8.322233653422e-03, +7.573408280313e-03}}},
    {st_venant_kirchhoff,
     State::u4,
     3.200431034483e-04,
     {{+1.396551724138e-01, +1.241379310345e-01, -5.571120689655e-02},
      {-1.396551724138e-01, +3.103448275862e-02, -2.726293103448e-02},
      {+0.000000000000e+00, -1.551724137931e-01, -2.370689655172e-02},
      {+0.000000000000e+00, +0.000000000000e+00, +1.066810344828e-01}}},
    {neo_hookean_log,
     State::u2,
     2.225642961364e-05,
     {{+8.611224813013e-03, -5.665925625467e-03, +1.281941026950e-02},
      {+7.428487140940e-03, +3.024577722802e-03, +8.686809534975e-04},
      {-7.586382079297e-03, +6.695115861788e-03, +4.191539720201e-03},
      {-8.453329874656e-03, -4.053767959123e-03, -1.787963094320e-02}}},
    {neo_hookean_log,
     State::u3,
     2.225642961364e-05,
     {{-2.282120984702e-03, -4.482746855283e-03, +1.566173968862e-02},
      {+6.687322027975e-03, -1.619825856643e-03, +4.212005044116e-03},
      {-2.011650593150e-03, +1.075911850888e-02, -3.760392065739e-04},
      {-2.393550450123e-03, -4.656545796951e-03, -1.949770552616e-02}}},
    {neo_hookean_isochoric,
     State::u2,
     2.227109064684e-05,
     {{+9.506352426730e-03, -3.875998284502e-03, +1.394494397728e-02},
      {+6.781224173079e-03, +2.206283721516e-03, +1.959080722899e-03},
      {-6.576522446297e-03, +5.644287182802e-03, +3.821839766551e-03},
      {-9.711054153512e-03, -3.974572619815e-03, -1.972586446673e-02}}},
    {neo_hookean_isochoric,
     State::u3,
     2.227109064684e-05,
     {{-8.679026712045e-04, -3.250888890964e-03, +1.698628941423e-02},
      {+5.347380198420e-03, -1.474638295808e-03, +4.890976726002e-03},
      {-1.912722360890e-03, +9.275398378762e-03, -1.535010592251e-04},
      {-2.566755166326e-03, -4.549871191990e-03, -2.172376508101e-02}}},
};

TEST(OneElement, EnergyAndForces) {
  const double volume = fem::element_geometry(one_tetrahedron(), 0).volume();
  EXPECT_NEAR(volume, 1.2e-7, 1e-21);
  for (const Row& row : kRows) {
    const Law law(row.law, reference_material());
    const Eigen::Matrix3d f = gradient_of(row.state);
    EXPECT_NEAR(volume * law.energy(f).value(), row.energy_j, 1e-11 * row.energy_j + 1e-18);
    const Eigen::Matrix<double, 3, 4> forces = node_forces(law, f);
    for (int a = 0; a < 4; ++a) {
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(forces(i, a), row.force_n[a][i], 1e-14 + 1e-12 * std::abs(row.force_n[a][i]))
            << static_cast<int>(row.law) << " u" << 1 + static_cast<int>(row.state);
      }
    }
  }
}

// E·h², the force that the stiffness makes of a strain of one, with the element's h.
constexpr double kForceScale = 1e4 * 1e-2 * 1e-2;

TEST(OneElement, ATurnMakesNoForce) {
  for (const LawKind kind :
       {corotational, st_venant_kirchhoff, neo_hookean_log, neo_hookean_isochoric}) {
    const Law law(kind, reference_material());
    EXPECT_LT(node_forces(law, gradient_of(State::u1)).norm(), 1e-10 * kForceScale);
    // Nor do forces have a moment about the element as it is deformed.
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    const mesh::TetMesh mesh = one_tetrahedron();
    const Eigen::Matrix3d f = gradient_of(State::u2);
    const Eigen::Matrix<double, 3, 4> forces = node_forces(law, f);
    for (int a = 0; a < 4; ++a) {
      const Eigen::Vector3d place = f * mesh.nodes[static_cast<std::size_t>(a)];
      moment += place.cross(forces.col(a));
    }
    EXPECT_LT(moment.norm(), 1e-12 * kForceScale * 1e-2);
  }
}

TEST(OneElement, InsideOutTheNeoHookeanOnesAreNotDefined) {
  for (const LawKind kind : {neo_hookean_log, neo_hookean_isochoric}) {
    EXPECT_FALSE(Law(kind, reference_material()).stress(gradient_of(State::u4)).has_value());
  }
}

struct Spectrum {
  State state;
  Linearisation linearisation;
  int zero;      // magnitude below 1e-9 of the largest
  int negative;  // below that
  double least;
};

// The largest eigenvalue is the same in every row.
constexpr Spectrum kSpectra[] = {
    {State::u2, Linearisation::exact, 3, 0, 0},
    {State::u2, Linearisation::warped, 6, 0, 0},
    {State::u3, Linearisation::exact, 3, 0, 0},
    {State::u3, Linearisation::warped, 6, 0, 0},
    {State::u4, Linearisation::warped, 6, 0, 0},
    {State::u4, Linearisation::exact, 3, 3, -6.038799e2},
};
constexpr double kLargest = 2.516157e+02;  // N/m

TEST(OneElement, EigenvaluesOfTheCorotationalTangents) {
  const Law law(corotational, reference_material());
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  for (const Spectrum& row : kSpectra) {
    const fem::ElementMatrix k =
        law.tangent(gradient_of(row.state), geometry, row.linearisation).value();
    const Eigen::VectorXd values = test::symmetric_eigenvalues(k);
    EXPECT_NEAR(values[11], kLargest, 0.51e-4);
    int zero = 0;
    int negative = 0;
    for (int i = 0; i < 12; ++i) {
      if (std::abs(values[i]) < 1e-9 * kLargest) {
        ++zero;
      } else if (values[i] < 0) {
        ++negative;
      }
    }
    EXPECT_EQ(zero, row.zero);
    EXPECT_EQ(negative, row.negative);
    EXPECT_NEAR(values[0], row.least, row.least == 0 ? 1e-9 * kLargest : 0.51e-4);
  }
}

// Q of F = Q·U with U upper triangular and its diagonal positive: the rotation of many corotational
// codes ("large" in SOFA).
Eigen::Matrix3d rotation_by_gram_schmidt(const Eigen::Matrix3d& f) {
  Eigen::Matrix3d q;
  q.col(0) = f.col(0).normalized();
  q.col(1) = (f.col(1) - q.col(0) * q.col(0).dot(f.col(1))).normalized();
  q.col(2) = q.col(0).cross(q.col(1));
  return q;
}

// Nodes 1 and 2 are led round a closed loop; the midpoint rule converges faster than any power of
// the step, since the integrand is smooth and periodic.
template <class Forces>
double work_round_a_loop(const Forces& forces_at) {
  const mesh::TetMesh mesh = one_tetrahedron();
  const fem::ElementGeometry geometry = fem::element_geometry(mesh, 0);
  const auto displacement = [](double t) {
    Eigen::Matrix<double, 3, 4> u = Eigen::Matrix<double, 3, 4>::Zero();
    const double angle = 2 * M_PI * t;
    u.col(1) = 2e-3 * Eigen::Vector3d(std::sin(angle), std::cos(angle) - 1, std::sin(2 * angle));
    u.col(2) = 3e-3 * Eigen::Vector3d(std::cos(angle) - 1, std::sin(angle), std::sin(angle));
    return u;
  };
  double work = 0;
  double sum = 0;
  constexpr int kSteps = 4000;
  for (int n = 0; n < kSteps; ++n) {
    const Eigen::Matrix<double, 3, 4> u = displacement((n + 0.5) / kSteps);
    Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
    for (int a = 0; a < 4; ++a) {
      f += u.col(a) * geometry.gradient[static_cast<std::size_t>(a)].transpose();
    }
    const double one = forces_at(f)
                           .cwiseProduct(displacement(static_cast<double>(n + 1) / kSteps) -
                                         displacement(static_cast<double>(n) / kSteps))
                           .sum();
    work += one;
    sum += std::abs(one);
  }
  return work / sum;
}

TEST(OneElement, NoWorkRoundAClosedLoop) {
  const Law law(corotational, reference_material());
  EXPECT_LT(
      std::abs(work_round_a_loop([&law](const Eigen::Matrix3d& f) { return node_forces(law, f); })),
      1e-8);
  // The same law with another rotation gains or loses work, so the test can tell.
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  const double mu = reference_material().lame_mu();
  const double lambda = reference_material().lame_lambda();
  const double ghost = work_round_a_loop([&](const Eigen::Matrix3d& f) {
    const Eigen::Matrix3d q = rotation_by_gram_schmidt(f);
    const Eigen::Matrix3d strain =
        0.5 * (q.transpose() * f + f.transpose() * q) - Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d p =
        q * (2 * mu * strain + lambda * strain.trace() * Eigen::Matrix3d::Identity());
    Eigen::Matrix<double, 3, 4> forces;
    for (int a = 0; a < 4; ++a) {
      forces.col(a) = geometry.volume() * p * geometry.gradient[static_cast<std::size_t>(a)];
    }
    return forces;
  });
  EXPECT_GT(std::abs(ghost), 1e-3);
}

}  // namespace
}  // namespace hvp::tissue::one_element_test
