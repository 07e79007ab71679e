#include <optional>
#include <utility>
#include <vector>

#include "models/config/input_error.h"
#include "models/fem/contact.h"
#include "models/fem/direct_solver.h"
#include "models/index.h"
#include "tables/hard_cases/accuracy.h"
#include "tables/hard_cases/board.h"
#include "tables/hard_cases/scene.h"

namespace hvp::tables {

namespace {

using Vector = std::vector<double>;

// The same problem with the constraint in the matrix and its columns in the load.
Problem constrained(const Problem& problem) {
  const fem::ContactConstraint constraint(problem.matrix, fem::ContactDiagonal::average);
  const double diagonal = problem.diagonal * constraint.diagonal();
  Problem result{.matrix = constraint.modified_matrix(problem.contact),
                 .load = Vector(problem.load.size()),
                 .contact = {}};
  constraint.modified_rhs(problem.load, problem.contact, problem.displacement, result.load);
  for (const int node : problem.contact) {
    double* block = result.matrix.block(static_cast<std::size_t>(result.matrix.find(node, node)));
    for (int i = 0; i < 3; ++i) {
      block[4 * i] = diagonal;
      result.load[at(3 * node + i)] = diagonal * problem.displacement[i];
    }
  }
  return result;
}

class StaticScene final : public CaseScene {
 public:
  explicit StaticScene(Problem problem) : problem_(std::move(problem)) {}

  const sparse::BlockMatrix& matrix() const override { return problem_.matrix; }
  CaseOutcome attempt(const fixed::Plan& plan) override;

 private:
  const Vector& exact();
  std::optional<Vector> solve_rounded(const Board& board) const;

  Problem problem_;
  Vector exact_;
};

// Once, when it is first asked for: a load that is refused has none.
const Vector& StaticScene::exact() {
  if (!exact_.empty()) return exact_;
  exact_.resize(problem_.load.size());
  fem::DirectSolver reference(problem_.matrix);
  if (problem_.contact.empty()) {
    reference.solve(problem_.load, exact_);
  } else {
    reference.solve_with_contact(problem_.load, problem_.contact, problem_.displacement, exact_);
  }
  return exact_;
}

// The solution of the system that the board has, of the load that the host forms.
std::optional<Vector> StaticScene::solve_rounded(const Board& board) const {
  const fixed::System& system = board.system();
  const fem::DirectSolver reference(fixed::dequantise(system.matrix));
  if (reference.singular()) return std::nullopt;
  Vector u(problem_.load.size());
  board.modified_load(problem_.load, problem_.displacement, u);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] *= system.scale[i];
  reference.solve(u, u);
  for (std::size_t i = 0; i < u.size(); ++i) u[i] *= system.scale[i];
  return u;
}

CaseOutcome StaticScene::attempt(const fixed::Plan& plan) {
  CaseOutcome outcome;
  try {
    Board board(problem_.matrix, plan);
    board.set_contact(problem_.contact);
    outcome.matrix = flags_of_matrix(board.system());
    outcome.words = board.solve(problem_.load, problem_.displacement);
    outcome.iterations = board.iterations();
    outcome.error_true = relative_error(board.displacement(), exact());
    outcome.largest_displacement = largest_magnitude(exact());
    if (plan.passes == 1) {
      const std::optional<Vector> rounded = solve_rounded(board);
      if (rounded) outcome.error_rounded = relative_error(board.displacement(), *rounded);
    }
    outcome.reference = flags_of_errors(outcome, plan);
  } catch (const InputError& error) {
    outcome.refusal = error.what();
  }
  return outcome;
}

}  // namespace

std::unique_ptr<CaseScene> make_scene(Problem problem) {
  if (problem.diagonal > 0) problem = constrained(problem);
  return std::make_unique<StaticScene>(std::move(problem));
}

}  // namespace hvp::tables
