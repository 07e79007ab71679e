#include <algorithm>
#include <utility>
#include <vector>

#include "models/fem/newmark.h"
#include "models/host/deviation.h"
#include "models/host/reference_run.h"
#include "tables/hard_cases/accuracy.h"
#include "tables/hard_cases/board.h"
#include "tables/hard_cases/scene.h"

namespace hvp::tables {

namespace {

using Vector = std::vector<double>;

class MovingScene final : public CaseScene {
 public:
  explicit MovingScene(Motion motion)
      : motion_(std::move(motion)),
        matrix_(newmark().effective_matrix()),
        exact_(trajectory(matrix_)) {}

  const sparse::BlockMatrix& matrix() const override { return matrix_; }
  CaseOutcome attempt(const fixed::Plan& plan) override;

 private:
  fem::Newmark newmark() const {
    const fem::Body& body = *motion_.body;
    return {body.stiffness(), body.mass(motion_.dynamics.mass), motion_.dynamics,
            motion_.time_step_s};
  }
  std::vector<int> contact(int frame) const {
    return motion_.touches(frame) ? std::vector<int>{motion_.contact} : std::vector<int>{};
  }
  Eigen::Vector3d displacement(int frame) const {
    return motion_.displacement * std::min(1.0, 2.0 * frame / motion_.frames);
  }
  std::vector<Vector> trajectory(const sparse::BlockMatrix& solved) const;

  Motion motion_;
  sparse::BlockMatrix matrix_;  // Â
  std::vector<Vector> exact_;   // a frame
};

// In double precision, as far as the solved matrix goes; nothing where that is singular.
std::vector<Vector> MovingScene::trajectory(const sparse::BlockMatrix& solved) const {
  host::ReferenceRun run(*motion_.body, motion_.dynamics, motion_.time_step_s, matrix_, solved);
  std::vector<Vector> result;
  if (run.singular()) return result;
  for (int frame = 1; frame <= motion_.frames; ++frame) {
    const std::vector<int> nodes = contact(frame);
    const std::vector<Eigen::Vector3d> held(nodes.size(), displacement(frame));
    run.step({nodes, held, {}, 0});
    result.emplace_back(run.displacement().begin(), run.displacement().end());
  }
  return result;
}

CaseOutcome MovingScene::attempt(const fixed::Plan& plan) {
  CaseOutcome outcome;
  fem::Newmark newmark = this->newmark();
  Board board(matrix_, plan);
  outcome.matrix = flags_of_matrix(board.system());
  std::vector<Vector> rounded;
  if (plan.passes == 1 && plan.settings.matrix_scaling == fixed::MatrixScaling::none) {
    rounded = trajectory(fixed::dequantise(board.system().matrix));
  }
  host::Deviation of_true;
  host::Deviation of_rounded;
  Vector f(motion_.body->load().size());
  for (int frame = 1; frame <= motion_.frames; ++frame) {
    const auto index = static_cast<std::size_t>(frame - 1);
    newmark.predict();
    newmark.rhs(motion_.body->load(), f);
    board.set_contact(contact(frame));
    outcome.words.merge(board.solve(f, displacement(frame)));
    outcome.iterations = std::max(outcome.iterations, board.iterations());
    newmark.update(board.displacement());
    of_true.add(board.displacement(), exact_[index]);
    if (!rounded.empty()) of_rounded.add(board.displacement(), rounded[index]);
    outcome.largest_displacement =
        std::max(outcome.largest_displacement, largest_magnitude(exact_[index]));
  }
  outcome.error_true = of_true.relative().value_or(0);
  outcome.error_rounded = of_rounded.relative();
  outcome.reference = flags_of_errors(outcome, plan);
  return outcome;
}

}  // namespace

std::unique_ptr<CaseScene> make_scene(Motion motion) {
  return std::make_unique<MovingScene>(std::move(motion));
}

}  // namespace hvp::tables
