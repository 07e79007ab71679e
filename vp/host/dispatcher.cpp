#include "vp/host/dispatcher.h"

#include "models/time/picoseconds.h"
#include "vp/frame/frame_tag.h"

namespace hvp::vp {

namespace {
std::optional<random::Source> source(const std::optional<random::TimeDistribution>& distribution,
                                     std::int64_t seed, const char* effect) {
  if (!distribution) return std::nullopt;
  return random::Source(*distribution, seed, effect);
}
}  // namespace

Dispatcher::Dispatcher(const host::Host& costs, std::int64_t seed, Ledger& ledger)
    : jitter_(source(costs.jitter, seed, "host.jitter")),
      wake_up_(source(costs.wake_up, seed, "host.wake_up")),
      ledger_(ledger) {
  if (costs.interrupt_latencies) {
    interrupts_.emplace(*costs.interrupt_latencies, seed, "host.interrupt_latencies");
  }
  if (costs.cores == 1) shared_.emplace(costs.shared_core());
}

Picoseconds Dispatcher::release_delay(std::int64_t number) const {
  return jitter_ ? to_picoseconds(jitter_->time_s(number)) : 0;
}

Picoseconds Dispatcher::interrupt_latency(std::int64_t frame, Picoseconds otherwise) {
  return interrupts_ && frame >= 0 ? interrupts_->next(frame) : otherwise;
}

void Dispatcher::wake(Tag& tag) {
  if (wake_up_ && tag.frame >= 0) delay(tag);
  if (shared_) take_core(tag);
  runs_since_ = now_ps();
  runs_for_ = tag.frame;
}

void Dispatcher::delay(Tag& tag) {
  if (tag.frame != frame_) {
    frame_ = tag.frame;
    awakened_ = 0;
  }
  const Picoseconds ready = now_ps();
  sc_core::wait(to_sc_time(to_picoseconds(wake_up_->time_s(frame_, awakened_++))));
  ledger_.extend(tag, Part::host, Phase::wake_up, ready, now_ps());
}

// Why the process still does not run is a span: the section that holds it up, the switch.
void Dispatcher::take_core(Tag& tag) {
  const auto until = [&](Picoseconds time, Phase phase) {
    const Picoseconds start = now_ps();
    if (time == start) return;
    sc_core::wait(to_sc_time(time - start));
    ledger_.extend(tag, Part::host, phase, start, time);
    if (phase != Phase::context_switch) return;
    ledger_.take({Resource::core_0, "servo process", name(phase), tag.frame, start, time});
  };
  const host::SharedCore::Dispatch dispatch = shared_->core.servo_ready(now_ps());
  if (dispatch.preempts) shared_->preempted.notify(to_sc_time(dispatch.unblocked - now_ps()));
  until(dispatch.unblocked, Phase::blocked);
  until(dispatch.runs, Phase::context_switch);
}

// The process' tenure: from its wake-up, or a tick at which it was busy, to its sleep or the next
// such tick.
void Dispatcher::servo_ran() const {
  const std::string_view what = runs_for_ < 0 ? "set-up" : "servo process";
  ledger_.take({Resource::core_0, "servo process", what, runs_for_, runs_since_, now_ps()});
}

void Dispatcher::other_ran(std::string_view what, Picoseconds since) const {
  ledger_.take({shared_ ? Resource::core_0 : Resource::core_1, "collision process", what, -1, since,
                now_ps()});
}

void Dispatcher::work_for(std::int64_t frame) {
  servo_ran();
  runs_since_ = now_ps();
  runs_for_ = frame;
}

void Dispatcher::sleep() {
  servo_ran();
  if (!shared_) return;
  shared_->core.servo_sleeps(now_ps());
  shared_->freed.notify(sc_core::SC_ZERO_TIME);
}

void Dispatcher::acquire_core() {
  if (!shared_) return;
  host::SharedCore& core = shared_->core;
  do {
    while (core.servo_has_it()) sc_core::wait(shared_->freed);
    const Picoseconds since = now_ps();
    const Picoseconds runs = core.other_takes(since);
    if (runs == since) continue;
    sc_core::wait(to_sc_time(runs - since), shared_->preempted);
    other_ran(name(Phase::context_switch), since);
  } while (!core.other_has_it());
}

bool Dispatcher::work(Picoseconds time) {
  constexpr std::string_view kPass = "collision pass";
  Picoseconds since = now_ps();
  if (!shared_) {
    sc_core::wait(to_sc_time(time));
    other_ran(kPass, since);
    return true;
  }
  host::SharedCore& core = shared_->core;
  for (core.other_begins(now_ps(), time); !core.other_done(now_ps());
       core.other_resumes(now_ps())) {
    since = now_ps();
    if (core.other_has_it()) {
      sc_core::wait(to_sc_time(core.other_ends() - now_ps()), shared_->preempted);
      other_ran(kPass, since);
    }
    if (core.other_done(now_ps())) break;
    if (core.other_progress() == 0) return false;
    acquire_core();
  }
  return true;
}

}  // namespace hvp::vp
