#include "vp/host/servo_process.h"

#include <algorithm>
#include <exception>

#include "vp/host/board_solver.h"
#include "vp/host/host_solver.h"

namespace hvp::vp {

namespace {
constexpr std::size_t kStackBytes = 1 << 20;  // the C driver runs on it

std::unique_ptr<FrameSolver> make_solver(const ServoSettings& settings,
                                         host::FrameComputation& computation,
                                         const DriverPort& port, const Work& work,
                                         HostMemory* memory) {
  if (computation.on_host() != nullptr) return std::make_unique<HostSolver>(computation, work);
  return std::make_unique<BoardSolver>(settings.solver, computation, port, work,
                                       settings.hold_saturated, memory);
}
}  // namespace

ServoProcess::ServoProcess(const sc_core::sc_module_name& name, const ServoSettings& settings,
                           const fem::Body& body, host::FrameComputation& computation,
                           const collision::ContactSearch& contacts, BoardAccess& access,
                           const DriverPort& port, Dispatcher& dispatcher, Exchange& exchange,
                           Ledger& ledger, Verdict& verdict, Session& session, HostMemory* memory)
    : sc_module(name),
      settings_(settings),
      body_(body),
      computation_(computation),
      access_(access),
      dispatcher_(dispatcher),
      exchange_(exchange),
      ledger_(ledger),
      verdict_(verdict),
      session_(session),
      begun_("begun"),
      work_(settings_.costs, settings_.untimed, access.tag(), access.time(), ledger),
      solver_(make_solver(settings_, computation, port, work_, memory)),
      health_(settings_.costs.recovery, *solver_),
      held_(body, contacts, to_picoseconds(contacts.settings().hand_over_s)),
      daq_(access),
      report_{{}, -1},
      forces_(held_.contacts().size(), Eigen::Vector3d::Zero()),
      force_sum_(forces_) {
  SC_HAS_PROCESS(ServoProcess);
  SC_THREAD(run);
  set_stack_size(kStackBytes);
}

ServoProcess::~ServoProcess() = default;

void ServoProcess::run() {
  // What is thrown here would otherwise end in the kernel's report of it.
  try {
    serve();
  } catch (...) {
    failure_ = std::current_exception();
    sc_core::sc_stop();
  }
}

void ServoProcess::serve() {
  const Picoseconds began = now_ps();
  set_up();
  access_.time().synchronise();
  // What was posted is not the first frame's to wait for.
  drain_();
  set_up_time_ = now_ps() - began;
  session_.begin = now_ps();
  session_.begun = true;
  health_.loop_begins(session_.begin);
  begun_.notify(sc_core::SC_ZERO_TIME);
  ledger_.begin();
  std::int64_t number = 0;
  while (number < settings_.frames && !stop_asked_()) {
    if (settings_.costs.pipeline_depth == 0) {
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
  health_.closed(solver_->close(), number);
  access_.time().synchronise();
  dispatcher_.work_for(-1);
  drain_();
  ledger_.finish();
  sc_core::sc_stop();
}

// Before the first frame there is time: a board that does not answer is asked again.
void ServoProcess::set_up() {
  access_.tag() = Tag{};
  const host::Recovery& policy = settings_.costs.recovery;
  for (int failed = 0;;) {
    bool done = false;
    hvp_status status = HVP_OK;
    while (status == HVP_OK && !done) status = solver_->set_up_piece(done);
    if (done) return;
    health_.set_up_failed(status, ++failed);
    wait(to_sc_time(policy.back_off(failed) * settings_.period));
  }
}

void ServoProcess::sleep_until(Picoseconds time) {
  dispatcher_.sleep();
  wait(to_sc_time(time - now_ps()));
}

// A process that is still at work at its tick goes on; one that slept has to be woken.
ServoProcess::Step ServoProcess::release(std::int64_t number) {
  access_.time().synchronise();
  const Picoseconds born = session_.begin + number * settings_.period;
  const Picoseconds released = born + dispatcher_.release_delay(number);
  const bool sleeps = now_ps() < released;
  if (sleeps) {
    sleep_until(released);
  } else {
    dispatcher_.work_for(number);
  }
  Frame& frame = ledger_.open(number, born);
  frame.time = born - session_.begin;
  frame.touches.resize(held_.contacts().size());
  access_.tag() = Tag{number, kBirth};
  ledger_.extend(access_.tag(), Part::host, Phase::release, born, now_ps());
  if (sleeps) dispatcher_.wake(access_.tag());
  return {&frame, {}};
}

void ServoProcess::frame(std::int64_t number) {
  Step step = release(number);
  Frame& frame = *step.frame;
  sense(frame);
  begin(step);
  collect(step);
  deliver(frame);
  advance(frame);
  publish(frame);
  note(frame);
  observe(frame);
  // The last safe force is out; now the board is brought back, as far as the period allows.
  recover(number);
  ledger_.work_done(number, access_.time().now());
  ledger_.close(number);
}

// The board gets its next job as soon as it can: what only the frame before needs comes after.
void ServoProcess::pipelined_frame(std::int64_t number) {
  Step step = release(number);
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
  begin(step);
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
  collect(*pending_);
  observe(*pending_->frame);
  advance(*pending_->frame);
  put_aside(*pending_);
}

void ServoProcess::hand_out_pending() {
  resume(*pending_);
  const Frame& frame = *pending_->frame;
  deliver(frame);
  publish(frame);
  note(frame);
  pending_.reset();
  ledger_.close(frame.number);
}

void ServoProcess::sense(Frame& frame) {
  frame.touches.front().tip = daq_.read_position();
  work_.spend(Phase::contact_lookup, settings_.costs.contact_lookup_s);
  access_.time().synchronise();
  const Picoseconds last_report = report_.pass_began;
  // A copy: the frame goes on while the next report arrives.
  report_ = exchange_.contact.read(now_ps());
  frame.contact_age = now_ps() - report_.pass_began;
  if (report_.pass_began == last_report) return;
  std::ranges::fill(force_sum_, Eigen::Vector3d::Zero());
  force_frames_ = 0;
}

void ServoProcess::begin(Step& step) {
  Frame& frame = *step.frame;
  frame.status = health_.solver_status();
  step.attempted = frame.solved();
  if (step.attempted) {
    solver_->set_deadline(frame.born + (1 + settings_.costs.pipeline_depth) * settings_.period);
    if (health_.lost_contact() || !std::ranges::equal(report_.contacts, held_.contacts())) {
      move_contact(frame);
    }
  }
  for (std::size_t i = 0; i < frame.touches.size(); ++i) {
    frame.touches[i].contact = held_.contacts()[i];
  }
  if (!frame.in_contact()) frame.contact_age = 0;
  if (frame.solved()) {
    computation_.hold(held_.hold(frame.born, frame.touches, settings_.period));
    const double operations = held_.operations() + computation_.hold_operations();
    if (operations > 0) work_.spend(Phase::hold, 0, operations);
    frame.status = solver_->begin(frame.flags);
  }
  held_.keep_tips(frame.born, frame.touches);
}

// A board that was set up again is told of the same contacts; for the host they go on.
void ServoProcess::move_contact(Frame& frame) {
  frame.status = solver_->move_contact(held_.nodes_of(report_.contacts));
  health_.told_contact();
  if (std::ranges::equal(report_.contacts, held_.contacts())) return;
  held_.change(report_.contacts, frame.born, frame.touches,
               {computation_.displacement(), computation_.velocity()});
  ++health_.counts().contact_changes;
}

// Without new forces the last ones stay.
void ServoProcess::collect(Step& step) {
  Frame& frame = *step.frame;
  if (frame.solved()) frame.status = solver_->end(frame.flags);
  health_.solve_ended({frame.number, frame.status, step.attempted}, frame.flags);
  if (frame.solved()) computation_.forces(forces_);
  for (std::size_t i = 0; i < forces_.size(); ++i) frame.touches[i].force = forces_[i];
}

void ServoProcess::deliver(const Frame& frame) {
  if (frame.solved()) work_.spend(Phase::force, 0, computation_.force_operations());
  // The device pushes back with what the user exerts on the body.
  if (!daq_.write_force(-frame.touch().force)) ++health_.counts().clamped_forces;
}

void ServoProcess::advance(Frame& frame) {
  if (!frame.solved()) return;
  solver_->finish(frame.flags);
  computation_.update();
  held_.solved(frame.born);
  work_.spend(Phase::update, 0, computation_.update_operations());
}

void ServoProcess::publish(const Frame& frame) {
  access_.time().synchronise();
  SceneState& scene = exchange_.scene.prepare(now_ps());
  scene.touches = frame.touches;
  // Timing only, the body stays as the mailbox has had it from the beginning.
  if (!computation_.timing_only()) {
    body_.expand(computation_.displacement(), scene.displacement);
    ++force_frames_;
    for (std::size_t i = 0; i < force_sum_.size(); ++i) {
      force_sum_[i] += frame.touches[i].force;
      scene.touches[i].force = force_sum_[i] / static_cast<double>(force_frames_);
    }
  }
  exchange_.scene.publish(now_ps());
}

void ServoProcess::note(const Frame& frame) {
  health_.counts().flags |= frame.flags;
  health_.counts().clamped_words += solver_->take_clamped_words();
}

void ServoProcess::observe(const Frame& frame) {
  ledger_.solved(frame, {computation_.held(), computation_.displacement()});
}

// Until the next tick; one span for all of it.
void ServoProcess::recover(std::int64_t number) {
  if (!health_.recovers()) return;
  const Tag tag = access_.tag();
  access_.tag() = Tag{};
  access_.time().synchronise();
  const Picoseconds began = now_ps();
  const Picoseconds ticks = (began - session_.begin) / settings_.period;
  health_.recover(number, session_.begin + (ticks + 1) * settings_.period);
  access_.tag() = tag;
  if (now_ps() > began) {
    ledger_.add({number, kBirth}, Part::host, Phase::recovery, began, now_ps());
  }
}

// Goes on with a frame that was put aside. What kept it waiting since its last span, another
// frame's work or the process' own sleep, is a span too; where the board has answered in the
// meantime the frame follows the board.
void ServoProcess::resume(const Step& step) {
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
