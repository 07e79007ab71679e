#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/integrator.h"
#include "models/fem/internal_forces.h"
#include "models/fem/tissue.h"
#include "models/tissue/constitution.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/law.h"

namespace hvp::tissue {

// A body of one of the material laws in the servo loop. The frame's equation is
//
//   r(u) = f̂ − M̂·u − f_int(u) − f_damp(u, ṽ + c·u) = 0
//
// with the scheme's f̂ and M̂ (fem::Newmark), thesis (3.24)–(3.28) with K·u replaced by the forces of
// the elements, and damping that turns with them (viscous.h). Generalised-α weighs the forces of
// the step's two ends, it does not ask for those between; r(u) is divided by 1 − α_f. A solver
// reaches it by increments with system(): the Â (K where static) of the body at rest, unless take()
// replaces it by that of a deformed one. Where the forces relax (prony.h), K and the tangent have
// the constant factor of a frame's change.
//
// The forces of a frame's solution are formed once, when it is known, and serve the next frame:
// where contact nodes move only the elements at them are visited.
class NonlinearTissue final : public fem::Tissue,
                              public fem::InternalForces,
                              public fem::RenewableSystem {
 public:
  // Keeps a reference to the body. Throws InputError for an unstable time integration, a material
  // or a parameter out of range, and for stiffness damping beside relaxation.
  NonlinearTissue(const fem::Body& body, const Constitution& constitution,
                  fem::ContactDiagonal diagonal, const std::optional<fem::Dynamics>& dynamics,
                  double period_s);
  NonlinearTissue(const NonlinearTissue&) = delete;
  NonlinearTissue& operator=(const NonlinearTissue&) = delete;

  const sparse::BlockMatrix& system() const override { return matrix_; }
  std::int64_t revision() const override { return revision_; }
  fem::RenewableSystem* renewable() override { return this; }
  const fem::ContactConstraint& constraint() const override { return constraint_; }
  fem::InternalForces& internal_forces() override { return *this; }

  std::optional<fem::Scheme> scheme() const override { return integrator_.scheme(); }

  void hold(const fem::Hold& hold) override;
  std::span<const double> load() const override { return integrator_.load(); }
  std::span<const double> external_force() const override { return integrator_.external_force(); }
  void forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) override;
  void advance(std::span<const double> u) override;
  std::span<const double> initial_displacement() const override {
    return integrator_.initial_displacement();
  }
  std::span<const double> velocity() const override { return integrator_.velocity(); }
  double hold_operations() const override { return integrator_.hold_operations(); }
  double force_operations() const override;
  double advance_operations() const override;

  bool linear() const override { return false; }
  double rounding_n() const override { return rounding_n_; }
  fem::ElementsFound evaluate(std::span<const double> u, std::span<double> q) override;
  fem::ElementsFound follow(std::span<const int> nodes, std::span<const Eigen::Vector3d> moved,
                            std::span<const double> u, std::span<double> q) override;
  double evaluate_operations() const override { return evaluate_operations_; }
  double follow_operations() const override { return follow_operations_; }

  // The damping's part is that of the frames in which the last evaluate() found the elements.
  fem::FormedSystem form(std::span<const double> u, sparse::BlockMatrix& a) override;
  double typical_operations() override;
  void take(const sparse::BlockMatrix& a) override;

  // ∂q/∂u at the displacements of the last evaluate(), without the change of the frame in which
  // damping acts. Its pattern is system()'s. Gives the elements that have no tangent.
  fem::ElementsFound tangent(sparse::BlockMatrix& k) const;
  // Ψ of the displacements of the last evaluate(), J.
  double energy() const;
  const ElasticBody& elastic() const { return elastic_; }

 private:
  std::vector<double> strained() const;
  bool damped() const { return damping_s_ > 0; }
  Motion motion(std::span<const double> u, std::span<const double> v) const;
  void expand_velocity(std::span<const double> u, std::span<double> v) const;
  void collect_elements(std::span<const double> u, std::span<double> q);
  void collect(std::span<const double> u, std::span<double> q);
  bool between_ends() const {
    return integrator_.newmark() != nullptr && integrator_.newmark()->between_ends();
  }
  void find_forces_at(std::span<const double> u);
  double collect_operations() const;
  double add_to_elastic(sparse::BlockMatrix& k) const;
  double relaxation_factor() const { return series_ ? series_->stiffness_factor() : 1; }
  bool elsewhere_as_known(std::span<const int> nodes, std::span<const double> u) const;
  void choose_elements_at(std::span<const int> nodes);

  const fem::Body& body_;
  ElasticBody elastic_;
  double damping_s_;  // β of Rayleigh's damping
  fem::Integrator integrator_;
  std::optional<PronySeries> series_;
  sparse::BlockMatrix matrix_;
  std::int64_t revision_ = 0;
  double support_;  // of inertia at the corners of a point over its mass, N/(m·kg)
  fem::ContactConstraint constraint_;
  std::vector<double> kept_diagonal_;  // N/m, of each active node that is held; otherwise zero

  // The forces of the elements, over mesh nodes, for these displacements and velocities.
  std::vector<double> forces_n_, u_full_, v_full_;
  std::optional<PronyForces<double>> memory_;  // over mesh nodes
  std::vector<double> relaxed_n_;              // the elements' forces as they have relaxed
  double memory_operations_ = 0;
  bool stale_ = true;  // the forces are not those of the last solution in this time step
  std::vector<double> reaction_n_, u_reaction_, v_reaction_;  // scratch of forces()
  std::vector<double> at_end_;  // scratch of advance(): the elements' forces, over active nodes
  std::vector<double> change_;  // scratch of advance()
  double rounding_n_;           // of the elements' forces at rest
  std::vector<Tensor<double>> frames_;  // of each element's points, in which they are damped
  std::vector<int> elements_;           // scratch: those at some nodes
  std::vector<char> chosen_;
  double evaluate_operations_ = 0;
  double follow_operations_ = 0;
  double reaction_operations_ = 0;
  double damping_operations_ = 0;
  double refind_operations_ = 0;
};

}  // namespace hvp::tissue
