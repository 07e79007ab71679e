#include "vp/host/collision_process.h"

#include <algorithm>
#include <span>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

CollisionProcess::CollisionProcess(const sc_core::sc_module_name& name, const host::Host& costs,
                                   bool untimed, collision::ContactSearch& search,
                                   Exchange& exchange, const Session& session,
                                   sc_core::sc_event& begun, Dispatcher& dispatcher)
    : sc_module(name),
      costs_(costs),
      untimed_(untimed),
      search_(search),
      exchange_(exchange),
      session_(session),
      begun_(begun),
      dispatcher_(dispatcher),
      reported_(exchange.contact.read(0).contacts) {
  SC_HAS_PROCESS(CollisionProcess);
  SC_THREAD(run);
}

void CollisionProcess::run() {
  wait(begun_);
  const Picoseconds period = costs_.graphics.period_ps();
  for (std::int64_t tick = 0;; ++tick) {
    const Picoseconds due = session_.begin + tick * period;
    // A tick that has passed entirely while the last pass went on is skipped.
    if (now_ps() >= due + period) {
      ++skipped_;
      continue;
    }
    if (now_ps() < due) wait(to_sc_time(due - now_ps()));
    pass();
  }
}

// The last report counts once a frame has used it. Until then U does not depend on it, and finding
// it again would aim the contact anew, as often as passes are faster than frames.
void CollisionProcess::search(const SceneState& scene) {
  std::span<const collision::Pass> passes;
  if (search_.settings().glides()) {
    passes = search_.nearest(scene.touches, scene.displacement);
  } else if (!std::ranges::equal(scene.touches, reported_, {}, &collision::Touch::contact)) {
    passes = search_.keep(reported_, scene.displacement);
  } else if (scene.has_force) {
    passes = search_.pass(scene.touches, scene.displacement);
  } else {
    passes = search_.pass_without_force(scene.touches, scene.displacement);
  }
  found_.clear();
  for (const collision::Pass& pass : passes) found_.push_back(pass.contact);
}

// On a shared core a pass begins with its first instruction: one that lost the core before has not
// looked at the scene yet.
void CollisionProcess::pass() {
  Picoseconds began = 0;
  for (bool worked = false; !worked;) {
    dispatcher_.acquire_core();
    began = now_ps();
    search(exchange_.scene.read(began));
    const double flops = search_.pass_flops();
    const Picoseconds time =
        untimed_ ? 0
                 : costs_.compute_ps(flops) +
                       costs_.graphics.drawing_ps(search_.surface().triangles().size());
    if (drawing_ != nullptr) {
      drawing_->notify(to_sc_time(untimed_ ? 0 : costs_.compute_ps(flops)));
    }
    worked = dispatcher_.work(time);
  }
  longest_ = std::max(longest_, now_ps() - began);
  reported_ = found_;
  ContactReport& report = exchange_.contact.prepare(now_ps());
  report.contacts = reported_;
  report.pass_began = began;
  exchange_.contact.publish(now_ps());
  ++passes_;
}

}  // namespace hvp::vp
