#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/dynamics.h"
#include "models/fixed/remedy.h"
#include "models/fixed/system.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

// What a hard case solves, in the board's words and beside them in double precision.
namespace hvp::tables {

// The bound within which a case has converged, on the error against the true model: the
// scenario's reference.tolerance and reference.solver_tolerance.
inline constexpr double kBound = 1e-2;

// One attempt with one plan.
struct CaseOutcome {
  std::string refusal;  // what the host said instead of solving; empty: it solved
  // ‖u - u_ref‖ / ‖u_ref‖; of a motion the mean over the frames, over the largest norm. Below the
  // least normal number everything counts as zero.
  double error_true = 0;
  std::optional<double> error_rounded;  // none where the rounded matrix is singular, or refined
  int iterations = 0;                   // of all passes; of a motion the most in a frame
  double largest_displacement = 0;      // m, of the double-precision solution
  stability::Flags words;               // what the board and the host see in the words
  stability::Flags matrix;              // what a factorisation of the rounded matrix says at set-up
  stability::Flags reference;           // what the double-precision solution adds

  stability::Flags flags() const;
  bool converged() const { return refusal.empty() && flags().empty() && error_true <= kBound; }
};

class CaseScene {
 public:
  virtual ~CaseScene() = default;
  virtual CaseOutcome attempt(const fixed::Plan& plan) = 0;
  // A, as the host has it.
  virtual const sparse::BlockMatrix& matrix() const = 0;

  stability::Flags model;  // poor_elements, locking: what is wrong before anything is solved

 protected:
  // zero_diagonal and negative_curvature of the rounded matrix. It depends on the words and the
  // scaling alone, so a scene asks for one contact only.
  stability::Flags flags_of_matrix(const fixed::System& system);

 private:
  std::map<std::pair<int, fixed::MatrixScaling>, stability::Flags> known_;
};

// A·u = f with the contact's nodes at u_c (thesis §3.7).
struct Problem {
  sparse::BlockMatrix matrix;                              // N/m
  std::vector<double> load;                                // N; also what no host should send
  std::vector<int> contact;                                // ascending
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m, of the contact
  // What stands on the contact's diagonal before the matrix is rounded, as a multiple of the
  // matrix' mean one. 0: as the board does it, the mean of the words, afterwards.
  double diagonal = 0;
};

std::unique_ptr<CaseScene> make_scene(Problem problem);

// A body under Newmark's rule. The contact is at u_c · min(1, 2·frame/frames), frames from 1.
struct Motion {
  std::shared_ptr<const fem::Body> body;
  fem::Dynamics dynamics;
  double time_step_s = 2e-3;
  int contact = 0;                                         // active node
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m
  int frames = 30;
  bool (*touches)(int frame) = nullptr;
};

std::unique_ptr<CaseScene> make_scene(Motion motion);

}  // namespace hvp::tables
