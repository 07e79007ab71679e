#include "vp/host/collision_process.h"

#include <algorithm>

#include "vp/frame_tag.h"

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
      dispatcher_(dispatcher) {
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

// What was reported last counts once a frame has used it. Until then U says nothing of it, and to
// find it again would aim the contact anew: as often as passes are faster than frames.
collision::Pass CollisionProcess::search(const SceneState& scene) {
  if (!(scene.contact == reported_)) return search_.keep(scene.displacement, reported_);
  return scene.has_force ? search_.pass(scene.tip, scene.displacement, scene.contact, scene.force)
                         : search_.pass_without_force(scene.tip, scene.displacement, scene.contact);
}

// On a shared core a pass begins with its first instruction: one that lost the core before has not
// looked at the scene yet.
void CollisionProcess::pass() {
  Picoseconds began = 0;
  collision::Pass result;
  for (bool worked = false; !worked;) {
    dispatcher_.acquire_core();
    began = now_ps();
    result = search(exchange_.scene.read(began));
    const Picoseconds time =
        untimed_ ? 0
                 : costs_.compute_ps(result.flops) +
                       costs_.graphics.drawing_ps(search_.surface().triangles().size());
    if (drawing_ != nullptr) {
      drawing_->notify(to_sc_time(untimed_ ? 0 : costs_.compute_ps(result.flops)));
    }
    worked = dispatcher_.work(time);
  }
  longest_ = std::max(longest_, now_ps() - began);
  reported_ = result.contact;
  ContactReport& report = exchange_.contact.prepare(now_ps());
  report.contact = reported_;
  report.pass_began = began;
  exchange_.contact.publish(now_ps());
  ++passes_;
}

}  // namespace hvp::vp
