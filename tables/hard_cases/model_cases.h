#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "models/fem/newmark.h"
#include "models/fem/renewal.h"
#include "models/host/renewal_counts.h"
#include "models/stability/flag.h"
#include "models/tissue/model.h"
#include "tables/hard_cases/cases.h"

// The hard cases of bodies that are not linear and of explicit steps: a motion in frames, solved as
// in a run, against Newton's method with the exact tangent or against four times as many steps.
namespace hvp::tables {

// With what a case is run, and what its remedies change; in the scenario's terms.
struct ModelPlan {
  tissue::Model model;          // object.model
  int passes = 2;               // refinement.passes
  bool explicit_steps = false;  // host.solver = "explicit"
  bool board = false;           // "board"; otherwise "cholesky"
  int matrix_bits = 12;         // solver.matrix_bits; four more are solver.vector_bits
  bool scaled = false;          // solver.matrix_scaling = "diagonal"
  fem::MatrixRenewal renewal;   // object.model.matrix
  fem::Scheme scheme = fem::Scheme::newmark;  // dynamics.scheme
  double period_s = 2e-3;                     // budget.period, the step
  int substeps = 0;                           // host.substeps; 0: as many as are stable at rest
  double poisson_ratio = 0;  // object.material.poisson_ratio, where a remedy may change it
  int slower = 1;            // the motion takes so many times as many frames
};

// "object.model.kind = "corotational", refinement.passes = 4": what differs.
std::string difference(const ModelPlan& from, const ModelPlan& to);

struct ModelOutcome {
  std::string refusal;         // the program's message; empty: it ran
  stability::Flags run;        // raised by the frames
  stability::Flags reference;  // raised by comparison with the truth
  // Of displacements, the mean over the frames over the largest norm; none where the frames or
  // their truth are no numbers.
  std::optional<double> error;
  double least_limit_s = 0;                     // of explicit steps; otherwise 0
  int substeps = 0;                             // likewise
  int unsolved = 0;                             // frames whose truth Newton's method did not find
  std::optional<host::RenewalCounts> renewals;  // with renewal
  double least_determinant = 1;                 // det F of any element of the truth
  bool finite = true;                           // every displacement and force was a number

  stability::Flags flags() const {
    stability::Flags all = run;
    all.merge(reference);
    return all;
  }
  bool converged() const {
    return refusal.empty() && finite && flags().empty() && error && *error <= kBound;
  }
};

struct ModelCase {
  std::string name;
  std::string expected;  // a sentence without its full stop
  Ending ending = Ending::converges;
  std::optional<stability::Flag> flag;  // that the first attempt must raise
  ModelPlan plan;
  std::function<ModelOutcome(const ModelPlan&)> attempt;
};

// Solved by the host's factors, and explicit steps.
std::vector<ModelCase> model_cases();
// Solved in the board's words.
std::vector<ModelCase> board_cases();

struct ModelTrail {
  ModelOutcome first, last;
  ModelPlan plan;  // of the last attempt
  int attempts = 0;
  bool remedied() const { return attempts > 1; }
};

// Attempts a case, and after each failure again with the remedy that its flags name, until it
// converges or nothing is left to do.
ModelTrail follow(const ModelCase& hard_case);

// The section of docs/hard-cases.md.
std::string model_cases_text();

}  // namespace hvp::tables
