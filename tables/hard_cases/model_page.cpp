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
- step doubled: substeps twice as long as the body at rest is stable for.

Bodies without the word *explicit* and *mass-spring* are solved by increments of the matrix at rest,
by the host's factors: what words do is above. They have 2 passes a frame and Newmark's rule (γ =
0.6, β = 0.605, α = 20 1/s); their truth is Newton's method with the exact tangent. Explicit steps
and springs have as many substeps as the body at rest asks for; their truth is four times as many.
*Error*: of the displacements, the mean over the frames over the largest norm. Converged is what has
no flag and an error of at most 1e-2. A remedy is what the flags' texts name, one after the other:
substeps for the least limit that was seen, a probe half as fast, up to the 16 passes that a scenario
may ask for, a corotational body, and for locking ν = 0.45. Tests:
`tests/hard_cases/model_cases_test.cpp`.

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

std::string model_cases_text() {
  MarkdownTable table({"case", "expected", "error", "flags", "remedy", "error and flags then"});
  for (const ModelCase& hard_case : model_cases()) {
    const ModelTrail trail = follow(hard_case);
    std::string remedy = "none needed";
    std::string then;
    if (!trail.first.converged()) {
      remedy = trail.remedied() ? "`" + difference(hard_case.plan, trail.plan) + "`"
                                : "no setting helps";
      if (!trail.last.converged() && trail.remedied()) remedy.insert(0, "in vain: ");
      if (trail.remedied()) {
        then = error_of(trail.last);
        then += ", ";
        then += flags_of(trail.last);
      }
    }
    table.add({hard_case.name, hard_case.expected, error_of(trail.first), flags_of(trail.first),
               remedy, then});
  }
  return kModelHead + table.text();
}

}  // namespace hvp::tables
