#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/newmark.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::fit {

// The known properties of the body whose material is sought. Its supports are the scenario's
// anchors; only the contact acts on it.
struct TissueBody {
  mesh::TetMesh mesh;
  std::vector<int> anchored;  // mesh nodes, ascending
  double density_kg_m3 = 1000;
  // Newmark's β and γ and the kind of mass; Rayleigh's α and β are what is sought. Empty: a static
  // body.
  std::optional<fem::Dynamics> dynamics;
  double period_s = 2e-3;  // the servo period, Newmark's time step
  // Contact nodes have the velocity of their prescribed motion and no acceleration
  // (fem::Hold::elapsed_s), as in the servo loop unless `contact.hand_over` is zero. False: as
  // thesis §3.7 has it literally.
  bool velocity_of_way = true;
};

// The parameters that are sought.
struct TissueValues {
  double young_modulus = 0;      // E, Pa
  double poisson_ratio = 0;      // ν
  double mass_damping = 0;       // Rayleigh's α, 1/s
  double stiffness_damping = 0;  // Rayleigh's β, s
};

// The coefficients of a quantity that is linear in Lamé's constants: `lambda` is its value at λ = 1
// Pa and μ = 0, `mu` that at λ = 0 and μ = 1 Pa. λ and μ are functions of E and ν. K = λ·K_λ +
// μ·K_μ, because an element's K is linear in D (thesis (3.4), (3.17)).
struct LamePair {
  double lambda = 0;
  double mu = 0;
};

// λ and μ in Pa, and their derivatives by E and by ν.
struct Lame {
  LamePair value;
  LamePair by_young_modulus;
  LamePair by_poisson_ratio;
};
Lame lame(double young_modulus, double poisson_ratio);

inline double combine(const LamePair& coefficient, const LamePair& of) {
  return coefficient.lambda * of.lambda + coefficient.mu * of.mu;
}

// A body that is touched at given nodes, which move together along one direction and are fixed in
// the two others (thesis §3.7). Its unknowns are those of the other nodes, in an order that keeps
// the factors of K and Â sparse. The contact is one number: its displacement.
//
//   K = [ K_ff  k_f ]    and M alike: K_ff over the unknowns, k_f the effect on them of a unit
//       [ k_fᵀ  k_c ]    displacement of the contact, k_c its effect on the contact
class TissueSystem {
 public:
  // `contact` is nodes of the mesh, ascending; `direction` has any length but zero. Throws
  // InputError for what fem::Body refuses, for a contact node that is anchored, not in the mesh, or
  // named twice, and for a contact that leaves no node free.
  TissueSystem(const TissueBody& body, std::span<const int> contact,
               const Eigen::Vector3d& direction);
  // The body without a contact: every node that is not anchored has its unknowns. Throws InputError
  // for what fem::Body refuses.
  explicit TissueSystem(const TissueBody& body);

  int unknowns() const { return static_cast<int>(row_begin.size()) - 1; }

  // K_λ, K_μ and M, lower and upper triangle, in compressed rows of one pattern. M in kg. They are
  // public because the time integration reads them all.
  std::vector<int> row_begin;
  std::vector<int> column;
  std::vector<LamePair> stiffness;
  std::vector<double> mass;
  bool lumped = false;             // M is diagonal
  std::vector<double> diagonal;    // the diagonal of M; empty unless lumped
  std::vector<int> first_unknown;  // of each mesh node's three; −1: it has none

  // The entries of k_f and m_f that are not zero.
  struct Coupling {
    int row = 0;
    LamePair stiffness;
    double mass = 0;
  };
  std::vector<Coupling> coupling;
  LamePair contact_stiffness;  // k_c, m² of force a unit of λ and μ: N/m over Pa
  double contact_mass = 0;     // m_c, kg

 private:
  struct Assembled;
  static Assembled assemble(const TissueBody& body);
  void reduce(const Assembled& full, std::span<const int> contact,
              const Eigen::Vector3d& direction);
};

}  // namespace hvp::fit
