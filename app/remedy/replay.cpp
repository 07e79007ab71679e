#include "app/remedy/replay.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/scene/unit_contacts.h"
#include "models/config/input_error.h"
#include "models/host/contact_hold.h"
#include "models/host/deviation.h"
#include "models/host/rounding_estimate.h"
#include "models/host/word_board.h"
#include "models/time/picoseconds.h"

namespace hvp::app {

Recorder::Recorder(std::int64_t frames) {
  sightings_.reserve(std::min(kMostFrames, static_cast<std::size_t>(frames)));
}

void Recorder::solved(const vp::Frame& frame, const vp::Solution& /*solution*/) {
  touched_ = touched_ || frame.in_contact();
  if (!touched_ && sightings_.size() == 2) {
    sightings_[0] = sightings_[1];
    sightings_.pop_back();
  }
  if (sightings_.size() == kMostFrames) return;
  sightings_.push_back({frame.time, frame.touches});
}

namespace {

// The displacements of every frame that is solved again are kept, in 64 MB at most.
constexpr std::size_t kMostNumbers = 8'000'000;
constexpr std::size_t kShown = 16;  // frames from one line of progress to the next

// Solves one frame as the board would, with all its passes.
void solve(host::FrameComputation& computation, host::WordBoard& board,
           std::vector<std::int32_t>& b) {
  while (computation.method().next(b)) {
    const fixed::Report report = board.solve(b);
    computation.method().accept(board.solution(), report.flags);
  }
}

// The same frame where contact is a proxy, with all of its solves.
void solve_with_proxies(host::FrameComputation& computation, host::GlidingContact& contact,
                        const fem::Hold& hold, host::WordBoard& board,
                        std::vector<std::int32_t>& b) {
  contact.look(hold.tips, computation.displacement());
  if (contact.needs_solution()) {
    computation.hold(contact.hold());
    computation.begin();
    solve(computation, board, b);
  }
  contact.solve(computation.displacement());
  if (!contact.changes()) return;
  computation.hold(contact.hold());
  if (contact.needs_solution()) {
    computation.go_on(contact.way());
  } else {
    computation.begin();
  }
  solve(computation, board, b);
  contact.apply();
}

}  // namespace

Replay::Replay(const Scene& scene, std::span<const Sighting> recording, std::size_t frames,
               double hand_over_s, Span span, const Progress& progress)
    : scene_(scene) {
  if (recording.empty()) return;
  const std::size_t unknowns = std::max<std::size_t>(1, scene.body().load().size());
  frames = std::min({frames, recording.size(), kMostNumbers / unknowns});
  const bool stateless = !scene.scenario().has_memory();
  if (stateless) stride_ = (recording.size() + frames - 1) / frames;
  const bool whole = stateless || span == Span::whole;
  solve_exactly(whole ? recording : recording.first(frames), frames, hand_over_s, progress);
}

void Replay::solve_exactly(std::span<const Sighting> recording, std::size_t frames,
                           double hand_over_s, const Progress& progress) {
  const Scenario& s = scene_.scenario();
  const std::size_t probes = recording.front().touches.size();
  const std::unique_ptr<fem::ReferenceModel> reference = make_reference(scene_);
  fem::ReferenceModel& run = *reference;
  host::ContactHold contact(scene_.body(), scene_.contacts(), to_picoseconds(hand_over_s), probes);
  const Picoseconds period = to_picoseconds(s.budget.period_s);
  std::vector<collision::Contact> contacts(probes);
  std::vector<Eigen::Vector3d> tips;
  for (std::size_t i = 0; i < recording.size(); ++i) {
    if (progress && i % kShown == 0) {
      progress(fmt::format("looking for a remedy: the true solution of frame {} of {}", i + 1,
                           recording.size()));
    }
    const Sighting& now = recording[i];
    std::ranges::transform(now.touches, contacts.begin(), &collision::Touch::contact);
    if (scene_.glide() == nullptr && !std::ranges::equal(contacts, contact.contacts())) {
      contact.nodes_of(contacts);
      contact.change(contacts, now.time, now.touches, {run.displacement(), run.velocity()});
    }
    tips.clear();
    std::ranges::transform(now.touches, std::back_inserter(tips), &collision::Touch::tip);
    const fem::Hold hold = scene_.glide() != nullptr ? fem::Hold::of_loads({}, tips)
                                                     : contact.hold(now.time, now.touches, period);
    run.step(hold);
    contact.keep_tips(now.time, now.touches);
    contact.solved(now.time);
    add_force(now, !hold.let_go.empty(), static_cast<std::int64_t>(i), run.forces().front(),
              exact_force_);
    for (const double u : run.displacement()) largest_ = std::max(largest_, std::abs(u));
    if (i % stride_ != 0 || frames_.size() == frames) continue;
    Held& held = frames_.emplace_back();
    held.sighting = now;
    held.kept.keep(hold);
    held.exact.assign(run.displacement().begin(), run.displacement().end());
  }
}

void Replay::add_force(const Sighting& at, bool fades, std::int64_t frame,
                       const Eigen::Vector3d& force, stability::ForceQuality& quality) const {
  stability::FeltForce felt{
      frame, to_seconds(at.time), at.touch().tip, force, at.touch().contact.node, fades, 0};
  if (at.touch().contact.spot.present()) {
    felt.foot = scene_.glide()->surface.closest(at.touch().tip).point;
  } else if (at.touch().contact.present()) {
    felt.pull = force.dot(scene_.contacts().surface().rest_normal(at.touch().contact.node));
  }
  quality.add(felt);
}

Replay::Result Replay::attempt(const fixed::Plan& plan) const {
  const Scenario& s = scene_.scenario();
  Result result;
  std::optional<host::Refinement> refinement;
  // With [refinement] a single pass counts as refined too: it starts from the residual.
  const bool refined = plan.passes > 1 || s.refinement.has_value();
  if (refined) {
    refinement = s.refinement.value_or(host::Refinement{});
    refinement->passes = plan.passes;
  }
  fem::MatrixRenewal renewal = s.object.renewal();
  renewal.every = plan.renew_every;
  if (plan.headroom > 0) renewal.headroom = plan.headroom;
  try {
    plan.settings.check();
    host::FrameComputation computation(make_tissue(s, scene_.body()), plan.settings, refinement,
                                       host::SolvedBy::board, host::Effort::computed, renewal);
    if (const auto estimate = estimate_rounding(scene_, computation)) {
      result.flags = estimate->flags(refined, s.reference.has_value());
    }
    host::WordBoard board(computation.board().matrix(), computation.board().settings());
    const sparse::BlockMatrix rounded = fixed::dequantise(computation.board().words());
    // The rounded model is one of a linear body; increments are always refined.
    std::unique_ptr<fem::ReferenceModel> rounded_run;
    bool rounded_singular = false;
    if (!refined) {
      auto linear = std::make_unique<host::ReferenceRun>(
          scene_.body(), s.dynamics, s.budget.period_s, computation.matrix(), rounded);
      rounded_singular = linear->singular();
      rounded_run = with_own_contact(scene_, std::move(linear));
    }
    std::optional<host::GlidingContact> glides;
    if (scene_.glide() != nullptr) {
      glides.emplace(scene_.body(), *scene_.glide());
      if (glides->needs_solution()) computation.expect_to_go_on();
    }
    std::vector<std::int32_t> b(computation.displacement().size());
    host::Deviation of_true;
    host::Deviation of_rounded;
    stability::ForceQuality quality;
    std::span<const int> present;
    std::int64_t number = 0;
    for (const Held& frame : frames_) {
      if (!result.flags.empty()) return result;
      const fem::Hold hold = frame.kept.hold();
      if (!std::ranges::equal(present, hold.nodes)) {
        computation.set_contact(hold.nodes);
        board.set_contact(hold.nodes, computation.board().diagonal_word());
        present = hold.nodes;
      }
      Eigen::Vector3d force;
      if (glides) {
        solve_with_proxies(computation, *glides, hold, board, b);
        force = glides->forces().front();
      } else {
        computation.hold(hold);
        computation.begin();
        solve(computation, board, b);
        force = computation.force();
      }
      computation.method().finish();
      result.flags.merge(computation.method().flags());
      computation.update();
      if (computation.renewal_is_due()) {
        result.flags.merge(computation.renew());
        result.growth = computation.renewals()->growth;
        board.renew(computation.board().matrix(), computation.board().diagonal_word());
      }
      add_force(frame.sighting, !hold.let_go.empty(), number++, force, quality);
      const bool in_contact = std::ranges::any_of(
          frame.sighting.touches,
          [](const collision::Touch& touch) { return touch.contact.present(); });
      of_true.add(computation.displacement(), frame.exact, 0, in_contact);
      if (!rounded_run || rounded_singular) continue;
      rounded_run->step(hold);
      of_rounded.add(computation.displacement(), rounded_run->displacement(), 0, in_contact);
    }
    result.flags.merge(host::accuracy_flags(s.reference.value_or(host::Reference{}),
                                            of_true.judged(),
                                            (refined ? of_true : of_rounded).typical()));
    // Flags that the exact force has too are not the solver's; frames left out would look like
    // steps of the force.
    for (const stability::Flag flag : {stability::Flag::limit_cycle, stability::Flag::force_step,
                                       stability::Flag::force_ringing}) {
      if (stride_ == 1 && quality.flags().has(flag) && !exact_force_.flags().has(flag))
        result.flags.raise(flag);
    }
    if (const auto of_frame = of_true.of_frame()) {
      result.median = of_frame->median;
      result.p95 = of_frame->p95;
    }
  } catch (const InputError&) {
    result.refused = true;
  }
  return result;
}

}  // namespace hvp::app
