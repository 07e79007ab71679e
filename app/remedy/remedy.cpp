#include "app/remedy/remedy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/devices/devices.h"
#include "app/remedy/replay.h"
#include "app/scene/frame_cost.h"
#include "models/accel/critical_path.h"
#include "models/accel/fit.h"
#include "models/config/input_error.h"
#include "models/fixed/remedy.h"

namespace hvp::app {

namespace {

using stability::Flag;
using stability::Flags;

constexpr int kMostAttempts = 30;
constexpr int kMostWithAll = 8;

// The number of frames for a touch and a good part of a press; fewer for a large body, which takes
// longer to solve.
std::size_t few_frames(const Scene& scene) {
  constexpr std::size_t kFrames = 256;
  constexpr std::size_t kUnknowns = 1500;
  const std::size_t unknowns = std::max(kUnknowns, scene.body().load().size());
  return std::max<std::size_t>(32, kFrames * kUnknowns / unknowns);
}

template <std::size_t n>
Flags among(Flags flags, const std::array<Flag, n>& set) {
  Flags result;
  for (const Flag flag : set) {
    if (flags.has(flag)) result.raise(flag);
  }
  return result;
}

constexpr std::array kOfWords = {
    Flag::saturation,      Flag::negative_curvature, Flag::zero_diagonal,
    Flag::stagnation,      Flag::scalar_overflow,    Flag::divergence,
    Flag::matrix_rounding, Flag::not_converged,      Flag::range_exceeded,
    Flag::wrapped,         Flag::limit_cycle,        Flag::matrix_word_beyond_scale};

// Flags with which the force is wrong, and therefore also the nodes that are touched.
constexpr std::array kSevere = {
    Flag::saturation,      Flag::negative_curvature, Flag::zero_diagonal,  Flag::stagnation,
    Flag::scalar_overflow, Flag::divergence,         Flag::range_exceeded, Flag::wrapped};

Flags of_hand_over(Flags flags) {
  return among(flags, std::array{Flag::force_step, Flag::force_ringing});
}

struct HandOverTrial {
  std::optional<double> calm_s;  // absent: none is better than the scenario's own
  Flags left;
  int attempts = 0;
};

// The first hand-over time, from the scenario's on, with which the exact solution's force has the
// fewest flags of steps and ringing. If it is the scenario's own and there are none, the solver has
// made the force do so.
HandOverTrial calmest_hand_over(const Scene& scene, std::span<const Sighting> recording) {
  const double present_s = scene.scenario().contact.search.hand_over_s;
  HandOverTrial trial;
  int fewest = std::numeric_limits<int>::max();
  for (const double hand_over_s : {present_s, 20e-3, 30e-3, 50e-3, 80e-3}) {
    if (hand_over_s < present_s) continue;
    ++trial.attempts;
    // No frame is solved again by attempt().
    const Replay replay(scene, recording, 1, hand_over_s, Replay::Span::whole);
    const Flags flags = of_hand_over(replay.exact_force().flags());
    const int count = std::popcount(flags.bits());
    if (count >= fewest) continue;
    fewest = count;
    trial.left = flags;
    if (hand_over_s > present_s || flags.empty()) trial.calm_s = hand_over_s;
    if (flags.empty()) break;
  }
  return trial;
}

std::string shortage(const Scene& scene) {
  std::string text;
  for (const accel::Resource& r : scene.usage().resources) {
    if (r.used <= r.available) continue;
    text += fmt::format("{}{} {} of {}", text.empty() ? "" : ", ", r.used, r.type, r.available);
  }
  for (const accel::Obstacle& o : scene.usage().obstacles) {
    text += (text.empty() ? "" : ", ") + o.reason;
  }
  return text;
}

class Candidate {
 public:
  Candidate(const Rebuild& rebuild, std::vector<std::string> settings)
      : settings_(std::move(settings)) {
    std::vector<std::string> overrides;
    for (const std::string& s : settings_) overrides.push_back(results::override_text(s));
    try {
      scene_ = rebuild(overrides);
    } catch (const InputError& e) {
      refusal_ = e.what();
    }
  }

  bool works() const { return scene_ && scene_->usage().fits() && clock_is_reached(); }
  const Scene* scene() const { return scene_.get(); }
  const std::vector<std::string>& settings() const { return settings_; }
  std::string reason() const {
    if (!scene_) return refusal_;
    const std::string text = shortage(*scene_);
    return text.empty() ? "the device does not reach the clock"
                        : scene_->device().name + ": " + text;
  }

 private:
  accel::WordLengths words() const {
    return accel::word_lengths(scene_->computation().board().settings());
  }
  bool clock_is_reached() const {
    try {
      accel::require_clock(
          {scene_->device(), scene_->scenario().accelerator, words(), scene_->pattern().nodes()});
      return true;
    } catch (const InputError&) {
      return false;
    }
  }

  std::vector<std::string> settings_;
  std::unique_ptr<Scene> scene_;
  std::string refusal_;
};

// The candidate with the settings that make its words fit the device; unchanged where none does.
Candidate fitting(Candidate candidate, const Rebuild& rebuild) {
  if (candidate.scene() == nullptr || !candidate.scene()->has_board()) return candidate;
  if (candidate.works()) return candidate;
  const Scene& scene = *candidate.scene();
  if (scene.scenario().accelerator.several) return candidate;
  const accel::WordLengths words = accel::word_lengths(scene.computation().board().settings());
  for (const accel::Proposal& proposal :
       accel::proposals_that_fit(scene.device(), scene.scenario().accelerator, words,
                                 scene.pattern(), devices::all_built_in())) {
    if (!proposal.remark.empty()) continue;
    std::vector<std::string> settings = candidate.settings();
    settings.insert(settings.end(), proposal.settings.begin(), proposal.settings.end());
    Candidate other(rebuild, std::move(settings));
    if (other.works()) return other;
  }
  return candidate;
}

fixed::Plan plan_of(const Scenario& s) {
  const fem::MatrixRenewal renewal = s.object.renewal();
  return {s.solver, s.refinement ? s.refinement->passes : 1, renewal.every,
          renewal.present() ? renewal.headroom : 0};
}

// Adds what the settings need of the device, and the worst frame's times with them.
void complete(const Scene& scene, const Measured& measured, const Rebuild& rebuild,
              results::TriedRemedy& remedy) {
  constexpr double kReserve = 0.99;
  const Candidate candidate = fitting(Candidate(rebuild, remedy.settings), rebuild);
  remedy.settings = candidate.settings();
  remedy.fits = candidate.scene() != nullptr && (!scene.has_board() || candidate.works());
  if (!remedy.fits) remedy.shortage = candidate.reason();
  if (candidate.scene() == nullptr) return;
  const std::vector<FrameStep> now = frame_steps(scene);
  const std::vector<FrameStep> then = frame_steps(*candidate.scene());
  remedy.before = {measured.latency_ps, measured.load_ps};
  const std::int64_t renewal =
      frame_ps(renewal_steps(*candidate.scene())) - frame_ps(renewal_steps(scene));
  remedy.after = {measured.latency_ps + latency_ps(then) - latency_ps(now),
                  measured.load_ps + frame_ps(then) - frame_ps(now) + renewal};
  const auto within = [](std::int64_t time, std::int64_t limit) {
    return static_cast<double>(time) <= kReserve * static_cast<double>(limit);
  };
  remedy.in_time = within(remedy.after.latency_ps, measured.budget_ps) &&
                   within(remedy.after.load_ps, measured.period_ps);
}

class SolverSearch {
 public:
  // The search uses the frames of `few`; those of `all` decide.
  SolverSearch(const Scene& scene, Flags flags, const Replay& few, const Replay& all,
               const Measured& measured, const Rebuild& rebuild, const Progress& progress)
      : scene_(scene),
        flags_(flags),
        few_(few),
        all_(all),
        measured_(measured),
        rebuild_(rebuild),
        progress_(progress) {
    extent_.largest_displacement = all.largest_displacement();
    extent_.renewable = scene.scenario().object.nonlinear() && scene.has_board();
    extent_.growth = measured.growth;
  }

  // Searches settings in addition to those of `remedy`.
  results::TriedRemedy find(results::TriedRemedy remedy, int most_passes) {
    const fixed::Plan original = plan_of(scene_.scenario());
    const fixed::Attempt attempt = [this](const fixed::Plan& plan) { return trial(few_, plan); };
    extent_.most_passes = most_passes;
    fixed::Search search = fixed::follow_remedies(original, {.refused = false, .flags = flags_},
                                                  extent_, attempt, kMostAttempts);
    fixed::take_back(original, attempt, search);
    if (takes_longer(search.plan, original)) {
      fixed::save_time(std::max(1, original.settings.iterations / 4), attempt, search);
    }
    remedy.attempts += search.attempts;
    if (search.last.cured()) go_on_with_all(search, remedy);
    if (search.plan == original) {
      remedy.left.merge(search.last.flags.empty() ? flags_ : search.last.flags);
      return remedy;
    }
    remedy.left.merge(search.last.flags);
    // A plan that does no better than the present one is no remedy.
    if (search.last.refused || !among(search.last.flags, kOfWords).empty()) {
      if (remedy.left.empty()) remedy.left = flags_;
      return remedy;
    }
    remedy.median = last_.median;
    remedy.p95 = last_.p95;
    for (std::string& s : fixed::changes(original, search.plan)) {
      remedy.settings.push_back(std::move(s));
    }
    complete(scene_, measured_, rebuild_, remedy);
    return remedy;
  }

 private:
  fixed::Trial trial(const Replay& replay, const fixed::Plan& plan) {
    ++attempts_;
    if (progress_) {
      progress_(fmt::format("looking for a remedy: attempt {}, of {} frames", attempts_,
                            replay.frames()));
    }
    last_ = replay.attempt(plan);
    // Of a run that goes astray the growth says nothing.
    if (last_.flags.has(Flag::matrix_word_beyond_scale)) {
      extent_.growth = std::max(extent_.growth, last_.growth);
    }
    return {.refused = last_.refused, .flags = last_.flags};
  }

  // A plan that is enough for a few frames may not be enough for all.
  void go_on_with_all(fixed::Search& search, results::TriedRemedy& remedy) {
    const fixed::Attempt attempt = [this](const fixed::Plan& plan) { return trial(all_, plan); };
    const fixed::Trial first = attempt(search.plan);
    search = fixed::follow_remedies(search.plan, first, extent_, attempt, kMostWithAll);
    remedy.attempts += 1 + search.attempts;
    remedy.frames = all_.frames();
  }

  static bool takes_longer(const fixed::Plan& plan, const fixed::Plan& original) {
    return plan.passes * plan.settings.iterations > original.passes * original.settings.iterations;
  }

  const Scene& scene_;
  Flags flags_;
  const Replay& few_;
  const Replay& all_;
  const Measured& measured_;
  const Rebuild& rebuild_;
  const Progress& progress_;
  fixed::Extent extent_;
  int attempts_ = 0;
  Replay::Result last_;  // of the last attempt
};

// Of the flags of a run with faults, those that the words raise without the faults.
Flags caused_by_words(const Scene& scene, std::span<const Sighting> recording, Flags flags) {
  const Replay replay(scene, recording, few_frames(scene),
                      scene.scenario().contact.search.hand_over_s, Replay::Span::first);
  const Flags of_words = replay.attempt(plan_of(scene.scenario())).flags;
  return Flags(flags.bits() & of_words.bits());
}

}  // namespace

std::optional<results::TriedRemedy> try_remedies(const Scene& scene, Flags flags,
                                                 std::span<const Sighting> recording,
                                                 const Measured& measured, const Rebuild& rebuild,
                                                 const Progress& progress) {
  Flags solver = scene.has_board() ? among(flags, kOfWords) : Flags();
  // A proxy is not handed over.
  Flags hand_over = scene.glide() == nullptr ? of_hand_over(flags) : Flags();
  if (!scene.scenario().faults.empty()) {
    // No setting undoes the effect of faults on the force.
    hand_over = Flags();
    if (!solver.empty()) solver = caused_by_words(scene, recording, solver);
  }
  if (!among(solver, kSevere).empty()) hand_over = Flags();
  if (scene.scenario().timing_only() || recording.empty()) return std::nullopt;
  if (solver.empty() && hand_over.empty()) return std::nullopt;
  if (progress) progress("looking for a remedy");

  results::TriedRemedy remedy;
  remedy.of = solver;
  remedy.of.merge(hand_over);
  remedy.frames = recording.size();
  double hand_over_s = scene.scenario().contact.search.hand_over_s;
  if (!hand_over.empty()) {
    const HandOverTrial trial = calmest_hand_over(scene, recording);
    remedy.attempts = trial.attempts;
    remedy.left = trial.calm_s ? trial.left : hand_over;
    if (!trial.calm_s) {
      hand_over_s = scene.scenario().contact.search.hand_over_s;
    } else if (*trial.calm_s > hand_over_s) {
      hand_over_s = *trial.calm_s;
      remedy.settings.push_back(fmt::format("contact.hand_over = \"{:g} ms\"", 1e3 * hand_over_s));
    }
  }
  if (solver.empty()) {
    if (remedy.settings.empty() && remedy.left.empty()) return std::nullopt;
    if (!remedy.settings.empty()) complete(scene, measured, rebuild, remedy);
    return remedy;
  }
  const Replay all(scene, recording, recording.size(), hand_over_s, Replay::Span::whole, progress);
  // A limit cycle shows only over many frames.
  const std::size_t few = solver.has(Flag::limit_cycle) ? recording.size() : few_frames(scene);
  const Replay first(scene, recording, few, hand_over_s, Replay::Span::first, progress);
  SolverSearch search(scene, solver, first, all, measured, rebuild, progress);
  results::TriedRemedy found = search.find(remedy, fixed::Extent{}.most_passes);
  // Frames in which nothing is displaced are no trial.
  if (!(all.largest_displacement() > 0)) found.frames = 0;
  if (found.settings.empty() || (found.fits && found.in_time)) return found;
  // Where there is no time for further passes, wider words may be enough.
  const int passes = plan_of(scene.scenario()).passes;
  results::TriedRemedy other = search.find(remedy, passes);
  const bool better = !other.settings.empty() && other.fits && other.in_time &&
                      (other.left.empty() || !found.left.empty());
  return better ? other : found;
}

}  // namespace hvp::app
