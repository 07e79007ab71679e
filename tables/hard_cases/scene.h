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
#include "models/fem/newmark.h"
#include "models/fixed/remedy.h"
#include "models/fixed/system.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

// The systems that hard cases solve, in the board's words and in double precision.
namespace hvp::tables {

// The largest error against the true model with which a case counts as converged. It is also the
// scenario's reference.tolerance and reference.solver_tolerance.
inline constexpr double kBound = 1e-2;

// The outcome of one attempt with one plan.
struct CaseOutcome {
  std::string refusal;  // the host's error message; empty: it solved
  // ‖u - u_ref‖ / ‖u_ref‖; for a motion the mean over the frames, divided by the largest norm.
  // Anything below the least normal number counts as zero.
  double error_true = 0;
  std::optional<double> error_rounded;  // none if the rounded matrix is singular, or refined
  int iterations = 0;                   // of all passes; for a motion the most in a frame
  double largest_displacement = 0;      // m, of the double-precision solution
  stability::Flags words;               // raised by board and host from the words
  stability::Flags matrix;              // raised at set-up by a factorisation of the rounded matrix
  stability::Flags reference;           // raised by comparison with the double-precision solution

  stability::Flags flags() const;
  bool converged() const { return refusal.empty() && flags().empty() && error_true <= kBound; }
};

class CaseScene {
 public:
  virtual ~CaseScene() = default;
  virtual CaseOutcome attempt(const fixed::Plan& plan) = 0;
  // The matrix A in double precision.
  virtual const sparse::BlockMatrix& matrix() const = 0;

  stability::Flags model;  // flags of the model itself: poor_elements, locking

 protected:
  // The flags zero_diagonal and negative_curvature of the rounded matrix. They depend on words and
  // scaling alone, so one contact suffices for a scene.
  stability::Flags flags_of_matrix(const fixed::System& system);

 private:
  std::map<std::pair<int, fixed::MatrixScaling>, stability::Flags> known_;
};

// The system A·u = f with the contact nodes at u_c (thesis §3.7).
struct Problem {
  sparse::BlockMatrix matrix;  // N/m
  std::vector<double> load;    // N; may contain values that no host should send
  std::vector<int> contact;    // ascending
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m, of the contact
  // The value on the contact nodes' diagonal before rounding, as a multiple of the matrix' mean
  // diagonal. 0: the mean of the words, set after rounding, as on the board.
  double diagonal = 0;
};

std::unique_ptr<CaseScene> make_scene(Problem problem);

// A body under Newmark's rule. The contact nodes are at u_c · min(1, 2·frame/frames), with frames
// counted from 1.
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
