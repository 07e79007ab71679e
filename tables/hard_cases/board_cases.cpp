#include <string>
#include <vector>

#include "tables/hard_cases/moved_block.h"

namespace hvp::tables {

namespace {

using stability::Flag;
using tissue::LawKind;

// Each rests until there have been renewals.
constexpr int kRest = 100;

const MovedBlock kBoardStrike{.frames = 3, .rest = kRest, .reach = 6e-3, .way = strike};
const MovedBlock kBoardThrough{.poisson_ratio = 0.3, .frames = 100, .way = through};
const MovedBlock kBoardLocked{
    .poisson_ratio = kLocked, .frames = 8, .rest = kRest, .reach = 6e-3, .way = press_a_little};
const MovedBlock kSlowTurn{.frames = 300, .rest = kRest, .reach = 1, .way = turn};
const MovedBlock kSlowOnStiff{.contrast = 1e6, .frames = 100, .reach = 6e-3, .way = press};
const MovedBlock kDeep{.frames = 150, .rest = kRest, .reach = 6e-3, .way = strike};

ModelPlan in_words(LawKind kind) {
  ModelPlan plan;
  plan.model.kind = kind;
  plan.board = true;
  plan.passes = 1;
  return plan;
}

ModelPlan locked_in_words(ModelPlan plan) {
  plan.poisson_ratio = kLocked;
  return plan;
}

ModelPlan renewed(ModelPlan plan, double headroom) {
  plan.renewal = {.every = 50, .headroom = headroom};
  return plan;
}

}  // namespace

std::vector<ModelCase> board_cases() {
  using enum LawKind;
  using enum Ending;
  std::vector<ModelCase> cases;
  for (const LawKind law : {corotational, neo_hookean_isochoric}) {
    const std::string kind(tissue::name(law));
    const bool warped = law == corotational;
    cases.push_back(made("fast strike, " + kind, "too few passes", remedied, Flag::not_converged,
                         in_words(law), kBoardStrike));
    cases.push_back(made("inversion, " + kind,
                         warped ? "goes on" : "no forces there: keeps the last solution", remedied,
                         Flag::not_converged, in_words(law), kBoardThrough));
    cases.push_back(made("ν = 0.4999, " + kind, "locked", remedied, Flag::not_converged,
                         locked_in_words(in_words(law)), kBoardLocked));
    cases.push_back(made("90° rotation, " + kind, "the matrix at rest leads elsewhere", remedied,
                         Flag::divergence, in_words(law), kSlowTurn));
  }
  cases.push_back(made("contrast 1e6, corotational", "the soft layers' words round to nothing",
                       remedied, Flag::not_converged, in_words(corotational), kSlowOnStiff));
  cases.push_back(made(
      "beyond the scale, neo-hookean-isochoric", "stiffens, and no word has room for it", remedied,
      Flag::matrix_word_beyond_scale, renewed(in_words(neo_hookean_isochoric), 1), kDeep));
  cases.push_back(made("too much headroom, neo-hookean-isochoric", "the words have four bits less",
                       remedied, Flag::not_converged, renewed(in_words(neo_hookean_isochoric), 16),
                       kDeep));
  return cases;
}

}  // namespace hvp::tables
