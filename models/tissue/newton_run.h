#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/direct_solver.h"
#include "models/fem/reference_model.h"
#include "models/tissue/nonlinear_tissue.h"

namespace hvp::tissue {

// The frames of a body that is not linear, solved to rounding by Newton's method with factors of
// the exact tangent. Factors serve as long as each step with them leaves a tenth of the residual or
// less; the tangent is then formed anew. Where it is not positive definite the matrix at rest leads
// on and, where that is slow, the tangent all the same. A step is halved until every element has
// forces and, once contact is where it is prescribed, until the residual falls.
class NewtonRun final : public fem::ReferenceModel {
 public:
  // A frame's residual is solved to this share of the largest force at a node, a little above what
  // rounding leaves, or to what rounding makes of the forces at rest.
  static constexpr double kTolerance = 1e-9;
  // What a frame may take; one that takes more is counted as unsolved. Frames that are solved have
  // been seen to form 5 tangents, and 11 where the body is turned inside out.
  static constexpr int kMostSteps = 60;
  static constexpr int kMostTangents = 24;
  // After so many unsolved frames in a row one in so many is tried, until one is solved: the others
  // stay where the last one ended, and count as unsolved.
  static constexpr int kPatienceFrames = 16;

  // Keeps a reference to the body. Throws as NonlinearTissue does.
  NewtonRun(const fem::Body& body, const Constitution& constitution,
            const std::optional<fem::Dynamics>& dynamics, double period_s, std::size_t probes);

  void solve(const fem::Hold& hold) override;
  void advance() override { tissue_.advance(u_); }
  std::span<const double> displacement() const override { return u_; }
  std::span<const double> velocity() const override { return tissue_.velocity(); }
  std::span<const Eigen::Vector3d> forces() const override { return of_probes_; }
  std::int64_t unsolved() const override { return unsolved_; }
  std::int64_t indefinite() const override { return indefinite_; }
  std::int64_t overflown() const override { return overflown_; }

  const NonlinearTissue& tissue() const { return tissue_; }
  // Of the last solve(): Newton's steps, and the largest residual after each, N.
  int steps() const { return static_cast<int>(residual_n_.size()) - 1; }
  std::span<const double> residual_n() const { return residual_n_; }
  // Tangents formed so far.
  std::int64_t tangents() const { return tangents_; }

 private:
  // The largest component of r outside the contact, N; infinity where an element has no forces.
  double look_at(std::span<const double> u, std::span<const int> contact);
  bool tries() const {
    return unsolved_in_a_row_ < kPatienceFrames || unsolved_in_a_row_ % kPatienceFrames == 0;
  }
  bool find_solution(const fem::Hold& hold);
  void factorise(bool anyhow);
  bool make_step(const fem::Hold& hold, double& residual);

  NonlinearTissue tissue_;
  sparse::BlockMatrix tangent_;
  std::optional<fem::DirectSolver> exact_, at_rest_;
  fem::DirectSolver* factors_ = nullptr;  // one of them
  std::vector<double> u_, trial_, q_, r_, direction_;
  double rounding_n_;                 // of a force at rest
  std::vector<Eigen::Vector3d> gap_;  // what contact nodes still have to move, m
  std::vector<Eigen::Vector3d> of_probes_;
  std::vector<double> residual_n_;
  double largest_force_n_ = 0;  // at a node, of the run so far
  std::int64_t unsolved_ = 0;
  std::int64_t unsolved_in_a_row_ = 0;
  std::int64_t tangents_ = 0;
  std::int64_t indefinite_ = 0;
  std::int64_t overflown_ = 0;
  bool overflows_ = false;  // an evaluation of this frame was beyond the law's energy
};

}  // namespace hvp::tissue
