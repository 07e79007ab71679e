#include "vp/host/servo_process.h"

#include <algorithm>
#include <exception>

namespace hvp::vp {

namespace {
constexpr std::size_t kServoStackBytes = 1 << 20;  // the C driver runs on it
}  // namespace

ServoProcess::ServoProcess(const sc_core::sc_module_name& name, const ServoSettings& settings,
                           Rendering& rendering, BoardAccess& access, const Work& work,
                           Dispatcher& dispatcher, Ledger& ledger, Verdict& verdict,
                           Session& session)
    : sc_module(name),
      settings_(settings),
      rendering_(rendering),
      access_(access),
      work_(work),
      dispatcher_(dispatcher),
      ledger_(ledger),
      verdict_(verdict),
      session_(session),
      begun_("begun"),
      daq_(access, rendering.probes(), settings.daq_read_bytes),
      nodes_(rendering.probes(), -1) {
  SC_HAS_PROCESS(ServoProcess);
  SC_THREAD(run);
  set_stack_size(kServoStackBytes);
  if (settings.port.present()) port_.emplace(settings.port, rendering.probes());
}

void ServoProcess::run() {
  // An exception would otherwise end in the kernel's report.
  try {
    serve();
  } catch (...) {
    failure_ = std::current_exception();
    sc_core::sc_stop();
  }
}

void ServoProcess::serve() {
  const Picoseconds began = now_ps();
  rendering_.set_up();
  access_.time().synchronise();
  // The first frame must not wait for writes that set-up has posted.
  drain_();
  set_up_time_ = now_ps() - began;
  session_.begin = now_ps();
  session_.begun = true;
  rendering_.loop_begins(session_.begin);
  begun_.notify(sc_core::SC_ZERO_TIME);
  ledger_.begin();
  std::int64_t number = 0;
  while (number < settings_.frames && !stop_asked_()) {
    if (settings_.pipeline_depth == 0) {
      frame(number);
    } else {
      pipelined_frame(number);
    }
    ++number;
    // A tick that has passed entirely while the process was at work had no frame.
    while (number < settings_.frames &&
           access_.time().now() >= session_.begin + (number + 1) * settings_.period) {
      verdict_.skip_tick();
      ++number;
    }
  }
  ticks_ = number;
  if (pending_) drain(number);
  access_.tag() = Tag{};
  access_.time().synchronise();
  rendering_.close(number);
  access_.time().synchronise();
  dispatcher_.work_for(-1);
  drain_();
  ledger_.finish();
  sc_core::sc_stop();
}

void ServoProcess::sleep_until(Picoseconds time) {
  dispatcher_.sleep();
  wait(to_sc_time(time - now_ps()));
}

// A process that is still at work at its tick goes on; one that slept has to be woken.
FrameStep ServoProcess::release(std::int64_t number) {
  access_.time().synchronise();
  const Picoseconds born = session_.begin + number * settings_.period;
  const Picoseconds released = born + dispatcher_.release_delay(number);
  const bool beyond_tick = now_ps() > born;
  const bool sleeps = now_ps() < released;
  if (sleeps) {
    sleep_until(released);
  } else {
    dispatcher_.work_for(number);
  }
  Frame& frame = ledger_.open(number, born);
  frame.time = born - session_.begin;
  frame.beyond_tick = beyond_tick;
  frame.not_woken = !sleeps;
  frame.touches.resize(rendering_.probes());
  access_.tag() = Tag{number, kBirth};
  ledger_.extend(access_.tag(), Part::host, Phase::release, born, now_ps());
  if (sleeps) dispatcher_.wake(access_.tag());
  return {&frame, {}};
}

void ServoProcess::frame(std::int64_t number) {
  FrameStep step = release(number);
  Frame& frame = *step.frame;
  sense(frame);
  rendering_.begin(step);
  rendering_.collect(step);
  damp(frame);
  deliver(frame);
  advance(frame);
  publish(frame);
  rendering_.note(frame);
  observe(frame);
  // The last safe force is out; now the board is brought back, as far as the period allows.
  recover(number);
  ledger_.work_done(number, access_.time().now());
  ledger_.close(number);
}

// The board gets its next job as soon as it can: what only the frame before needs comes after.
void ServoProcess::pipelined_frame(std::int64_t number) {
  FrameStep step = release(number);
  sense(*step.frame);
  if (pending_) {
    put_aside(step);
    take_pending();
    if (!pending_->frame->solved()) {
      hand_out_pending();
      recover(number);
    }
    resume(step);
  }
  rendering_.begin(step);
  put_aside(step);
  if (pending_) hand_out_pending();
  pending_ = step;
  ledger_.work_done(number, access_.time().now());
}

// The last frame's force comes in the period after it, like every other's.
void ServoProcess::drain(std::int64_t tick) {
  access_.time().synchronise();
  const Picoseconds due =
      session_.begin + tick * settings_.period + dispatcher_.release_delay(tick);
  const bool sleeps = now_ps() < due;
  if (sleeps) sleep_until(due);
  resume(*pending_);
  if (sleeps) dispatcher_.wake(access_.tag());
  put_aside(*pending_);
  take_pending();
  hand_out_pending();
}

void ServoProcess::take_pending() {
  resume(*pending_);
  rendering_.collect(*pending_);
  damp(*pending_->frame);
  observe(*pending_->frame);
  advance(*pending_->frame);
  put_aside(*pending_);
}

void ServoProcess::hand_out_pending() {
  resume(*pending_);
  Frame& frame = *pending_->frame;
  deliver(frame);
  publish(frame);
  rendering_.note(frame);
  pending_.reset();
  ledger_.close(frame.number);
}

void ServoProcess::sense(Frame& frame) {
  daq_.read_positions(frame.touches);
  if (port_) {
    port_->read(frame);
    const double operations = port_->read_operations();
    if (operations > 0) work_.spend(Phase::hold, 0, operations);
  }
  rendering_.look(frame);
}

// Before the frame is observed: its record has all that goes out.
void ServoProcess::damp(Frame& frame) {
  if (port_) port_->send(frame);
}

void ServoProcess::deliver(Frame& frame) {
  double operations = frame.solved() ? rendering_.force_operations() : 0;
  if (port_) operations += port_->send_operations();
  if (frame.solved() || operations > 0) work_.spend(Phase::force, 0, operations);
  if (!daq_.write_forces(frame)) ++rendering_.counts().clamped_forces;
}

void ServoProcess::advance(Frame& frame) {
  if (frame.solved()) rendering_.advance(frame);
}

void ServoProcess::publish(const Frame& frame) {
  access_.time().synchronise();
  rendering_.publish(frame);
}

void ServoProcess::observe(const Frame& frame) {
  if (!std::ranges::equal(frame.touches, nodes_, {},
                          [](const collision::Touch& touch) { return touch.contact.node; })) {
    ++rendering_.counts().contact_changes;
    std::ranges::transform(frame.touches, nodes_.begin(),
                           [](const collision::Touch& touch) { return touch.contact.node; });
  }
  ledger_.solved(frame, rendering_.solution());
}

// Until the next tick; one span for all of it.
void ServoProcess::recover(std::int64_t number) {
  if (!rendering_.recovers()) return;
  const Tag tag = access_.tag();
  access_.tag() = Tag{};
  access_.time().synchronise();
  const Picoseconds began = now_ps();
  const Picoseconds ticks = (began - session_.begin) / settings_.period;
  rendering_.recover(number, session_.begin + (ticks + 1) * settings_.period);
  access_.tag() = tag;
  if (now_ps() > began) {
    ledger_.add({number, kBirth}, Part::host, Phase::recovery, began, now_ps());
  }
}

// Goes on with a frame that was put aside. What kept it waiting since its last span, another
// frame's work or the process' own sleep, is a span too; where the board has answered in the
// meantime the frame follows the board.
void ServoProcess::resume(const FrameStep& step) {
  access_.time().synchronise();
  access_.tag() = step.tag;
  access_.follow_interrupt();
  const Tag& tag = access_.tag();
  const Picoseconds since = tag.cause == kBirth
                                ? step.frame->born
                                : step.frame->spans[static_cast<std::size_t>(tag.cause)].end;
  if (since == now_ps()) return;
  ledger_.extend(access_.tag(), Part::host, Phase::pipeline, since, now_ps());
}

}  // namespace hvp::vp
