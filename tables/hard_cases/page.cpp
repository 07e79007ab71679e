#include <vector>

#include <fmt/format.h>

#include "models/fem/direct_solver.h"
#include "models/stability/flag.h"
#include "tables/hard_cases/cases.h"
#include "tables/hard_cases/constant_load.h"
#include "tables/hard_cases/cost.h"
#include "tables/hard_cases/model_cases.h"
#include "tables/pages.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

using stability::Flag;
using stability::Flags;

constexpr const char* kHead = R"(# Hard cases of the fixed-point solver

<!-- Made by `./hvp tables hard-cases > docs/hard-cases.md`: do not edit. -->

What becomes of a system that the board's words can hardly hold, and what helps. Every case ends
within the bound, or in a named flag; what the flag names is then done, and done again, until the
case converges or nothing is left to do. Tests: `tests/hard_cases/`, which assert what stands here.
Code: `tables/hard_cases/` (the cases), `models/fixed/remedy.h` (the remedies).

<!-- not run: writes into the checkout -->
```sh
./hvp tables hard-cases > docs/hard-cases.md
```

## How it is measured

- The body is the sphere of thesis §6.2.4 by TetGen, 503 nodes, E = 10 kPa, ν = 0.45, the lowest
  15 % of its nodes held and its top pressed in by a tenth of its radius, unless the case says
  otherwise.
- First attempt: Jacobi-PCG, 80 iterations from zero, 12-bit matrix, 16-bit vectors, a range of
  20 mm; a trajectory starts every frame from the last one.
- *True* is the error of the displacements against the true model, in double precision; *rounded*
  that against the system that the board has. ‖u − u_ref‖ / ‖u_ref‖; of a trajectory the mean over
  its frames, over the largest norm.
- A case has **converged** with no flag up and a true error of at most 1e-2 (`reference.tolerance`
  and `reference.solver_tolerance` set to that).
- Flags without a mark are seen in the words, by the board or the host. *(set-up)*: by a
  factorisation of the rounded matrix before the first solve. *(reference)*: only against the
  solution in double precision; a run without `[reference]` does not have these, and its accuracy
  is null.
- The remedies are applied as `fixed::next_remedy()` gives them, which is the order in which the
  flags' texts name them. What is not needed any more once a case has converged is taken back:
  *remedy* is what is left, with the fewest iterations and passes.
- *Frame* is what solving costs in a frame before and after, on the thesis' board: the solves at
  100 MHz, b and u over 32-bit PCI at 33 MHz, and what the host computes for them. The period is
  2 ms. *Device*: the smaller of the two that holds the words.

)";

constexpr const char* kConstantHead = R"(
## One million frames of constant load

Every frame starts from the last one's solution. The body is a cube of six tetrahedra with four
free nodes; 6 iterations. *Distance*: the farthest that a word is from the solution of the rounded
system (refined: of the true one), in units of the last place, in the third and in the last quarter
of the frames.

)";

constexpr const char* kConstantTail = R"(
A static solve stands still after a few frames: from then on its state, the words of u, never
changes again. Under Newmark's rule the state is the host's doubles too. Plain CG rounds b to the
static scale, and the rule feeds that back: it does not come to rest, though it does not drift.
Jacobi-PCG keeps b in 32 bits and does. Refined frames stay within a fraction of a unit.
)";

std::string names(Flags flags, const char* mark) {
  std::string text;
  for (unsigned i = 0; i < static_cast<unsigned>(Flag::count); ++i) {
    const auto flag = static_cast<Flag>(i);
    if (!flags.has(flag)) continue;
    text += (text.empty() ? "" : ", ") + std::string(stability::describe(flag).name);
  }
  return text.empty() ? text : text + mark;
}

Flags without(Flags flags, Flags known) { return Flags(flags.bits() & ~known.bits()); }

void append(std::string& list, const std::string& more) {
  if (!more.empty()) list += (list.empty() ? "" : ", ") + more;
}

// Each flag where it is seen first: in the words, at set-up, against the reference.
std::string flags_of(const CaseOutcome& outcome, Flags model) {
  Flags known = outcome.words;
  std::string text = names(known, "");
  append(text, names(without(outcome.matrix, known), " (set-up)"));
  known.merge(outcome.matrix);
  append(text, names(without(outcome.reference, known), " (reference)"));
  append(text, names(model, " (model)"));
  return text.empty() ? "none" : text;
}

std::string errors_of(const CaseOutcome& outcome) {
  return scientific(outcome.error_true) + " / " +
         (outcome.error_rounded ? scientific(*outcome.error_rounded) : "–");
}

std::string milliseconds(double us) {
  return fmt::format("{:.2f}{}", us / 1000, us > kPeriodUs ? " (late)" : "");
}

// Without the tables' names, which a reader of a row knows.
std::string shortened(std::string change) {
  for (const std::string table : {"solver.", "refinement."}) {
    for (std::size_t k = change.find(table); k != std::string::npos; k = change.find(table)) {
      change.erase(k, table.size());
    }
  }
  return change;
}

std::string remedy_of(const Case& hard_case, const Trail& trail) {
  if (trail.remedies.empty()) return "none needed";
  const std::string change = shortened(fixed::difference(hard_case.plan, trail.plan));
  if (trail.converged) return "`" + change + "`";
  return "no setting of the board helps; in vain: `" + change + "`";
}

// The condition number of the system without contact, in double precision.
std::string condition_of(const sparse::BlockMatrix& matrix) {
  constexpr double kTwoDigits = 1e-3;
  const fem::DirectSolver solver(matrix);
  return scientific(fem::extreme_eigenvalues(matrix, solver, kTwoDigits).condition());
}

std::vector<std::string> row(const Case& hard_case) {
  const Trail trail = follow(hard_case);
  if (!trail.refusal.empty()) {
    return {
        hard_case.name, hard_case.expected, "", "refused: " + trail.refusal, "", "", "", "", ""};
  }
  const FrameCost before = frame_cost(trail.scene->matrix(), hard_case.plan);
  const FrameCost after = frame_cost(trail.scene->matrix(), trail.plan);
  std::string frame = milliseconds(before.total_us());
  if (!trail.remedies.empty()) frame += " → " + milliseconds(after.total_us());
  const std::string last = trail.converged ? scientific(trail.last.error_true)
                                           : scientific(trail.last.error_true) + ", " +
                                                 flags_of(trail.last, trail.model);
  return {hard_case.name,
          hard_case.expected,
          condition_of(trail.scene->matrix()),
          errors_of(trail.first),
          std::to_string(trail.first.iterations),
          flags_of(trail.first, trail.model),
          remedy_of(hard_case, trail),
          last,
          frame + "; " + after.device};
}

std::string constant_loads() {
  constexpr int kFrames = 1'000'000;
  using fixed::Method;
  MarkdownTable table(
      {"solve", "last change", "period", "distance, third quarter", "last quarter"});
  const auto add = [&table](const char* name, const ConstantLoad& load) {
    table.add({name,
               load.last_change == load.frames ? "to the end" : std::to_string(load.last_change),
               load.period == 0 ? "none" : std::to_string(load.period),
               fmt::format("{:.2f}", load.distance_before), fmt::format("{:.2f}", load.distance)});
  };
  add("static, CG", static_load(Method::cg, kFrames));
  add("static, Jacobi-PCG", static_load(Method::jacobi_pcg, kFrames));
  add("Newmark, 2 ms, CG", dynamic_load(Method::cg, 1, kFrames));
  add("Newmark, 2 ms, Jacobi-PCG", dynamic_load(Method::jacobi_pcg, 1, kFrames));
  add("Newmark, 2 ms, Jacobi-PCG, 2 passes", dynamic_load(Method::jacobi_pcg, 2, kFrames));
  return table.text();
}

std::string flags_and_remedies() {
  MarkdownTable table({"flag", "raised when", "remedy, in this order"});
  for (unsigned i = 0; i < static_cast<unsigned>(Flag::count); ++i) {
    const stability::Description& d = stability::describe(static_cast<Flag>(i));
    table.add({"`" + std::string(d.name) + "`", std::string(d.meaning), std::string(d.remedy)});
  }
  return table.text();
}

}  // namespace

std::string hard_cases_page() {
  std::string text = kHead;
  text += "## The cases\n";
  for (const Group& group : hard_cases()) {
    MarkdownTable table({"case", "expected", "κ", "true / rounded", "iterations", "flags",
                         "remedy that works", "true error then", "frame, ms; device"});
    for (const Case& hard_case : group.cases) table.add(row(hard_case));
    text += "\n### " + group.title + "\n\n" + table.text();
  }
  text += kConstantHead + constant_loads() + kConstantTail;
  text += model_cases_text();
  text += "\n## Flags and remedies\n\n" + flags_and_remedies();
  return text;
}

}  // namespace hvp::tables
