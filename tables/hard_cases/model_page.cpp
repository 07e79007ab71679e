#include <string>
#include <vector>

#include <fmt/format.h>

#include "tables/hard_cases/model_cases.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

constexpr const char* kModelHead = R"(
## Bodies that are not linear, and explicit steps

A block of 20 × 20 × 10 mm, 4 × 4 × 2 cells, E = 10 kPa, ν = 0.45 (inversion: 0.3), clamped below,
in frames of 2 ms. What is led goes on its way and then rests for as many frames.

- fast strike: nodes within 6 mm of the upper face's centre, 5 mm in 3 frames (0.8 m/s);
- inversion: the node there, past the one below it;
- ν = 0.4999: the nodes of the strike, 0.2 mm;
- 90° rotation: the whole upper face, in 24 frames;
- spring of length zero: in a block of one layer the node is led onto a clamped one;
- step doubled: substeps twice as long as the body at rest is stable for; with generalised-α a
  period of 4 ms;
- contrast 1e6: the lower layer that much stiffer, and the strike's nodes pressed by 2 mm.

Bodies without the word *explicit* and *mass-spring* are solved by increments of the matrix at rest,
by the host's factors: what words do is [beneath](#in-the-boards-words). They have 2 passes a frame and Newmark's rule (γ =
0.6, β = 0.605, α = 20 1/s); their truth is Newton's method with the exact tangent. Explicit steps
and springs have as many substeps as the body at rest asks for; their truth is four times as many.
*Least det F* is that of any element in the truth's frames: a node that is led past the place of
another need not turn an element inside out, as what is under it gives way. *Error*: of the displacements, the mean over the frames over the largest norm. Converged is what has
no flag and an error of at most 1e-2. A remedy is what the flags' texts name, one after the other:
substeps for the least limit that was seen, a probe half as fast, up to the 16 passes that a scenario
may ask for, a matrix that is renewed every 50, 10, or every frame, a corotational body, and for locking ν = 0.45. Tests:
`tests/hard_cases/model_cases_test.cpp`.

)";

constexpr const char* kBoardHead = R"(
### In the board's words

The same block in words of 12 and 16 bits: Jacobi-PCG, 80 iterations, a range of 30 mm. Each case is
solved with one and two passes, with the matrix at rest and with one that is renewed after every
50th frame (`object.model.matrix`, headroom 1.25 unless the case is about it). The remedy is looked
for from the case's own plan, which has one pass: two passes, then a renewal every 50 frames, the
headroom that the matrix' growth asks for, and then as above.

- fast strike and ν = 0.4999 as above, and then 100 frames of rest; inversion in 100 frames;
- 90° rotation in 300 frames (0.6 s);
- beyond the scale, too much headroom: the strike's nodes 5 mm deep in 150 frames, with a headroom
  of 1 and of 16, renewed.

)";

std::string flags_of(const ModelOutcome& outcome) {
  if (!outcome.refusal.empty()) return "refused: " + outcome.refusal;
  std::string text;
  for (unsigned i = 0; i < static_cast<unsigned>(stability::Flag::count); ++i) {
    const auto flag = static_cast<stability::Flag>(i);
    if (!outcome.flags().has(flag)) continue;
    text += (text.empty() ? "" : ", ") + std::string(stability::describe(flag).name);
    if (!outcome.run.has(flag)) text += " (reference)";
  }
  return text.empty() ? "none" : text;
}

std::string error_of(const ModelOutcome& outcome) {
  if (!outcome.refusal.empty()) return "–";
  if (!outcome.error) return "no number";
  return outcome.unsolved > 0 ? fmt::format("{} ({} frames have no truth)",
                                            scientific(*outcome.error), outcome.unsolved)
                              : scientific(*outcome.error);
}

}  // namespace

namespace {

// "`host.substeps = 14`", or what there is instead.
std::string remedy_of(const ModelCase& hard_case, const ModelTrail& trail) {
  if (trail.first.converged()) return "none needed";
  if (!trail.remedied()) return "no setting helps";
  const std::string remedy = "`" + difference(hard_case.plan, trail.plan) + "`";
  return trail.last.converged() ? remedy : "in vain: " + remedy;
}

std::string outcome_of(const ModelOutcome& outcome) {
  return error_of(outcome) + ", " + flags_of(outcome);
}

std::string determinant_of(const ModelOutcome& outcome) {
  return outcome.refusal.empty() ? fmt::format("{:.2g}", outcome.least_determinant) : "–";
}

std::string host_table() {
  MarkdownTable table(
      {"case", "expected", "least det F", "error", "flags", "remedy", "error and flags then"});
  for (const ModelCase& hard_case : model_cases()) {
    const ModelTrail trail = follow(hard_case);
    table.add({hard_case.name, hard_case.expected, determinant_of(trail.first),
               error_of(trail.first), flags_of(trail.first), remedy_of(hard_case, trail),
               trail.remedied() ? outcome_of(trail.last) : ""});
  }
  return table.text();
}

std::string board_table() {
  MarkdownTable table({"case", "expected", "one pass", "two passes", "one pass, renewed",
                       "two passes, renewed", "remedy", "error and flags then"});
  for (const ModelCase& hard_case : board_cases()) {
    std::vector<std::string> row = {hard_case.name, hard_case.expected};
    for (const bool renewed : {false, true}) {
      for (const int passes : {1, 2}) {
        ModelPlan plan = hard_case.plan;
        plan.passes = passes;
        plan.renewal.every = renewed ? 50 : 0;
        row.push_back(outcome_of(hard_case.attempt(plan)));
      }
    }
    const ModelTrail trail = follow(hard_case);
    row.push_back(remedy_of(hard_case, trail));
    row.push_back(trail.remedied() ? outcome_of(trail.last) : "");
    table.add(row);
  }
  return table.text();
}

}  // namespace

std::string model_cases_text() { return kModelHead + host_table() + kBoardHead + board_table(); }

}  // namespace hvp::tables
