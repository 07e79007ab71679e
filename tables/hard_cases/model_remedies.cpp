#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "models/tissue/explicit_tissue.h"
#include "tables/hard_cases/moved_block.h"

namespace hvp::tables {

using stability::Flag;
using stability::Flags;
using tissue::LawKind;

std::string difference(const ModelPlan& from, const ModelPlan& to) {
  std::vector<std::string> changes;
  if (name(from.model) != name(to.model)) {
    changes.push_back(fmt::format("object.model.kind = \"{}\"", name(to.model)));
  }
  if (from.passes != to.passes) {
    changes.push_back(fmt::format("refinement.passes = {}", to.passes));
  }
  if (from.substeps != to.substeps) {
    changes.push_back(fmt::format("host.substeps = {}", to.substeps));
  }
  if (from.poisson_ratio != to.poisson_ratio) {
    changes.push_back(fmt::format("object.material.poisson_ratio = {:g}", to.poisson_ratio));
  }
  if (from.matrix_bits != to.matrix_bits) {
    changes.push_back(fmt::format("solver.matrix_bits = {}, solver.vector_bits = {}",
                                  to.matrix_bits, to.matrix_bits + 4));
  }
  if (from.scaled != to.scaled) changes.push_back("solver.matrix_scaling = \"diagonal\"");
  if (from.renewal.every != to.renewal.every) {
    changes.push_back(fmt::format("object.model.matrix.renew_every = {}", to.renewal.every));
  }
  if (from.renewal.headroom != to.renewal.headroom) {
    changes.push_back(fmt::format("object.model.matrix.headroom = {:g}", to.renewal.headroom));
  }
  if (from.slower != to.slower) {
    changes.push_back(fmt::format("a probe {} times as slow", to.slower / from.slower));
  }
  return fmt::format("{}", fmt::join(changes, ", "));
}

namespace {

// What the flags' texts name first that is not done yet.
std::optional<ModelPlan> next_plan(const ModelPlan& plan, const ModelOutcome& outcome) {
  constexpr int kSlowest = 2;
  constexpr int kMostSubsteps = 512;
  constexpr int kFewPasses = 2;
  constexpr int kRenewEvery = 50;
  constexpr int kWide = 20;
  constexpr double kTooMuch = 2;   // a bit of every word
  constexpr int kMostPasses = 16;  // the most that a scenario may ask for
  ModelPlan next = plan;
  const Flags flags = outcome.flags();
  if (plan.poisson_ratio > kUnlocked) {
    next.poisson_ratio = kUnlocked;  // what the flag `locking` names, which a run has at set-up
    return next;
  }
  if (!outcome.refusal.empty()) {
    if (!plan.explicit_steps || plan.substeps == 0) return std::nullopt;
    next.substeps = 0;  // the message offers it
    return next;
  }
  if (plan.explicit_steps && flags.has(Flag::unstable_step)) {
    const auto needed = static_cast<int>(
        std::ceil(kPeriodS / std::max(tissue::ExplicitTissue::kShare * outcome.least_limit_s,
                                      kPeriodS / kMostSubsteps)));
    if (needed > outcome.substeps) {
      next.substeps = needed;
      return next;
    }
  }
  if (flags.has(Flag::inverted_element) && plan.slower < kSlowest) {
    next.slower = 2 * plan.slower;
    return next;
  }
  if (plan.explicit_steps) {
    if (flags.has(Flag::inverted_element) || outcome.substeps >= kMostSubsteps) {
      return std::nullopt;
    }
    next.substeps = 2 * outcome.substeps;
    return next;
  }
  if (outcome.renewals) {
    // What the matrix grew to, with a tenth for what it grows to with other words.
    double wanted = std::ceil(11 * outcome.renewals->growth) / 10;
    const bool beyond = flags.has(Flag::matrix_word_beyond_scale);
    if (beyond) wanted = std::max(wanted, std::ceil(11 * plan.renewal.headroom) / 10);
    if (beyond || (wanted > 0 && plan.renewal.headroom >= kTooMuch * wanted)) {
      next.renewal.headroom = wanted;
      return next;
    }
  }
  if (plan.board && flags.has(Flag::zero_diagonal) && !plan.scaled) {
    next.scaled = true;
    return next;
  }
  if (plan.board && plan.passes >= kFewPasses && !plan.renewal.present()) {
    next.renewal.every = kRenewEvery;
    return next;
  }
  if (plan.passes < kMostPasses) {
    next.passes = 2 * plan.passes;
    return next;
  }
  if (plan.slower < kSlowest) {
    next.slower = 2 * plan.slower;
    return next;
  }
  if (plan.board && plan.matrix_bits < kWide) {
    next.matrix_bits = kWide;
    return next;
  }
  if (plan.renewal.every != 1) {
    next.renewal.every = !plan.renewal.present() ? kRenewEvery : plan.renewal.every > 10 ? 10 : 1;
    return next;
  }
  if (!flags.has(Flag::inverted_element) || plan.model.kind == LawKind::corotational) {
    return std::nullopt;
  }
  next.model.kind = LawKind::corotational;
  return next;
}

// With a matrix that follows the body fewer passes may be enough.
void take_back_passes(const ModelCase& hard_case, ModelTrail& trail) {
  for (int passes = hard_case.plan.passes; passes < trail.plan.passes; passes *= 2) {
    ModelPlan fewer = trail.plan;
    fewer.passes = passes;
    const ModelOutcome outcome = hard_case.attempt(fewer);
    ++trail.attempts;
    if (!outcome.converged()) continue;
    trail.plan = fewer;
    trail.last = outcome;
    return;
  }
}

}  // namespace

ModelTrail follow(const ModelCase& hard_case) {
  constexpr int kMost = 16;
  ModelTrail trail;
  trail.plan = hard_case.plan;
  trail.first = hard_case.attempt(trail.plan);
  trail.last = trail.first;
  trail.attempts = 1;
  while (!trail.last.converged() && trail.attempts < kMost) {
    const std::optional<ModelPlan> next = next_plan(trail.plan, trail.last);
    if (!next) break;
    trail.plan = *next;
    trail.last = hard_case.attempt(trail.plan);
    ++trail.attempts;
  }
  if (trail.last.converged() && trail.plan.renewal.every != hard_case.plan.renewal.every) {
    take_back_passes(hard_case, trail);
  }
  return trail;
}

}  // namespace hvp::tables
