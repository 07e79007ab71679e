#include "vp/host/servo_process.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <string>

#include <spdlog/spdlog.h>

#include "models/plant/daq.h"
#include "models/stability/flag.h"
#include "vp/device/daq_board.h"
#include "vp/host/board_solver.h"
#include "vp/host/host_solver.h"

namespace hvp::vp {

namespace {
std::uint32_t bit(stability::Flag flag) { return std::uint32_t{1} << static_cast<unsigned>(flag); }

constexpr std::size_t kStackBytes = 1 << 20;  // the C driver runs on it

std::unique_ptr<FrameSolver> make_solver(const ServoSettings& settings,
                                         host::FrameComputation& computation,
                                         const BoardAccess& access, const Work& work,
                                         HostMemory* memory) {
  if (computation.on_host() != nullptr) return std::make_unique<HostSolver>(computation, work);
  return std::make_unique<BoardSolver>(settings.solver, computation, access, work,
                                       settings.hold_saturated, memory);
}

// What a board that is there can answer: it may do better at the next attempt.
bool may_pass(hvp_status status) {
  return status == HVP_ERROR_NO_DEVICE || status == HVP_ERROR_BUS || status == HVP_ERROR_DATA ||
         status == HVP_ERROR_TIMEOUT || status == HVP_ERROR_BOARD;
}
}  // namespace

ServoProcess::ServoProcess(const sc_core::sc_module_name& name, const ServoSettings& settings,
                           const fem::Body& body, host::FrameComputation& computation,
                           const collision::ContactSearch& contacts, BoardAccess& access,
                           Dispatcher& dispatcher, Exchange& exchange, Ledger& ledger,
                           Verdict& verdict, Session& session, HostMemory* memory)
    : sc_module(name),
      settings_(settings),
      body_(body),
      computation_(computation),
      contacts_(contacts),
      access_(access),
      dispatcher_(dispatcher),
      exchange_(exchange),
      ledger_(ledger),
      verdict_(verdict),
      session_(session),
      begun_("begun"),
      work_(settings_.costs, settings_.untimed, access.tag(), access.time(), ledger),
      solver_(make_solver(settings_, computation, access, work_, memory)),
      recovery_(settings_.costs.recovery, *solver_),
      hand_over_(std::llround(contacts.settings().hand_over_s * 1e12)) {
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
  if (faults_ != nullptr) faults_->begin(session_.begin);
  begun_.notify(sc_core::SC_ZERO_TIME);
  for (FrameObserver* observer : observers_) observer->begun();
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
  // What went wrong before says more than that a lost board cannot be closed.
  const hvp_status closed = solver_->close();
  if (counts_.last_error == HVP_OK) note(closed, number);
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
    note(status, -1);
    if (faults_ != nullptr) faults_->notice_failure(0);
    if (++failed == policy.attempts || !may_pass(status)) {
      // Without a frame no miss would be counted, and the run would look like one that held.
      throw std::runtime_error(std::string("the board could not be set up: ") +
                               hvp_status_text(status));
    }
    ++counts_.failed_set_ups;
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
  Step step;
  step.number = number;
  step.born = session_.begin + number * settings_.period;
  const Picoseconds released = step.born + dispatcher_.release_delay(number);
  const bool sleeps = now_ps() < released;
  if (sleeps) {
    sleep_until(released);
  } else {
    dispatcher_.work_for(number);
  }
  ledger_.open(number, step.born);
  access_.tag() = Tag{number, kBirth};
  ledger_.extend(access_.tag(), Part::host, Phase::release, step.born, now_ps());
  if (sleeps) dispatcher_.wake(access_.tag());
  return step;
}

void ServoProcess::frame(std::int64_t number) {
  Step step = release(number);
  sense(step);
  begin(step);
  collect(step);
  deliver(step);
  advance(step);
  publish(step);
  record(step);
  observe(step);
  // The last safe force is out; now the board is brought back, as far as the period allows.
  recover(number);
  ledger_.frame(number).work_done = access_.time().now();
  ledger_.close(number);
}

// The board gets its next job as soon as it can: what only the frame before needs comes after.
void ServoProcess::pipelined_frame(std::int64_t number) {
  Step step = release(number);
  sense(step);
  if (pending_) {
    put_aside(step);
    take_pending();
    if (pending_->status != HVP_OK) {
      hand_out_pending();
      recover(number);
    }
    resume(step);
  }
  begin(step);
  put_aside(step);
  if (pending_) hand_out_pending();
  pending_ = step;
  ledger_.frame(number).work_done = access_.time().now();
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
  observe(*pending_);
  advance(*pending_);
  put_aside(*pending_);
}

void ServoProcess::hand_out_pending() {
  resume(*pending_);
  deliver(*pending_);
  publish(*pending_);
  record(*pending_);
  ledger_.close(pending_->number);
  pending_.reset();
}

void ServoProcess::sense(Step& step) {
  step.tip = read_position();
  work_.spend(Phase::contact_lookup, settings_.costs.contact_lookup_s);
  access_.time().synchronise();
  // A copy: the frame goes on while the next report arrives.
  step.report = exchange_.contact.read(now_ps());
  step.looked_up = now_ps();
  if (step.report.pass_began == last_report_) return;
  last_report_ = step.report.pass_began;
  force_sum_.setZero();
  force_frames_ = 0;
}

void ServoProcess::begin(Step& step) {
  if (recovery_.ready()) {
    solver_->set_deadline(step.born + (1 + settings_.costs.pipeline_depth) * settings_.period);
    if (board_lost_contact_ || !(step.report.contact == contact_)) move_contact(step);
  } else {
    step.status = recovery_.status();
    step.without_board = true;
  }
  step.contact = contact_;
  if (step.status == HVP_OK) {
    hold_contact(step);
    step.status = solver_->begin(step.flags);
  }
  sights_[1] = sights_[0];
  sights_[0] = {step.born, step.tip};
}

// Where the present contact wanted its nodes, or would have.
collision::Aim ServoProcess::aim_at(const Sight& sight) const {
  collision::Aim aim{sight.born, Eigen::Vector3d::Zero()};
  if (contact_.present()) {
    aim.displacement = contacts_.prescribed_displacement(contact_, sight.tip);
  }
  return aim;
}

void ServoProcess::hold_contact(const Step& step) {
  const Picoseconds since = updated_.value_or(step.born - settings_.period);
  computation_.hold(hand_over_.hold(aim_at({step.born, step.tip}),
                                    1e-12 * static_cast<double>(step.born - since)));
  const double operations = hand_over_.operations() + computation_.hold_operations();
  if (operations > 0) work_.spend(Phase::hold, 0, operations);
}

// A board that was set up again is told of the same contact; for the host it goes on.
void ServoProcess::move_contact(Step& step) {
  next_contact_.clear();
  if (step.report.contact.present()) {
    for (const int node : contacts_.patch(step.report.contact.node)) {
      next_contact_.push_back(body_.active_index(node));
    }
  }
  step.status = solver_->move_contact(next_contact_);
  board_lost_contact_ = false;
  if (step.report.contact == contact_) return;
  contact_ = step.report.contact;
  ++counts_.contact_changes;
  const Sight now{step.born, step.tip};
  const Sight last = sights_[0].value_or(now);
  hand_over_.change(next_contact_, aim_at(sights_[1].value_or(last)), aim_at(last),
                    computation_.displacement(), computation_.velocity());
}

void ServoProcess::collect(Step& step) {
  if (step.status == HVP_OK) step.status = solver_->end(step.flags);
  mend(step);
  count_ticks_without_force(step);
  if (step.status == HVP_OK) {
    // What was only late is in the frame's latency.
    if (faults_ != nullptr) faults_->notice(FaultKind::late_dma, step.number);
    step.force = computation_.force();
  } else {
    hold(step);
  }
}

// No new force: the last one stays.
void ServoProcess::hold(Step& step) {
  step.force = held_force_;
  step.flags |= step.status == HVP_ERROR_SATURATED ? bit(stability::Flag::saturation)
                                                   : bit(stability::Flag::solver_timeout);
  ++counts_.held_frames;
  if (!step.without_board) fail(step);
}

void ServoProcess::fail(const Step& step) {
  note(step.status, step.number);
  ++counts_.driver_errors;
  if (faults_ != nullptr) faults_->notice_failure(step.number);
  if (solver_->survives(step.status)) return;
  board_lost_contact_ = true;
  recovery_.begin(step.number, step.status);
}

// What the driver has put right in the meantime.
void ServoProcess::mend(const Step& step) {
  const Mended mended = solver_->take_mended();
  counts_.mended.lost_interrupts += mended.lost_interrupts;
  counts_.mended.lost_acknowledgements += mended.lost_acknowledgements;
  counts_.mended.aborted += mended.aborted;
  counts_.mended.damaged += mended.damaged;
  count(HVP_ERROR_BUS, step.number, mended.aborted);
  count(HVP_ERROR_DATA, step.number, mended.damaged);
  if (faults_ == nullptr) return;
  if (mended.lost_interrupts > 0) faults_->notice(FaultKind::lost_interrupt, step.number);
  if (mended.lost_acknowledgements > 0) {
    // Of the frame before, where the next one's STATUS told; of this one, where the bridge did.
    faults_->notice(FaultKind::master_abort, step.number - 1);
    faults_->notice(FaultKind::master_abort, step.number);
  }
  if (mended.aborted > 0) faults_->notice(FaultKind::master_abort, step.number);
  if (mended.damaged > 0) faults_->notice(FaultKind::corrupted_word, step.number);
  if ((step.flags & bit(stability::Flag::saturation)) != 0) {
    faults_->notice(FaultKind::saturated_solve, step.number);
  }
}

void ServoProcess::count_ticks_without_force(const Step& step) {
  const std::int64_t end = step.status == HVP_OK ? step.number : step.number + 1;
  // The ticks that had none since the last solved frame.
  if (end - last_solved_ > 1) {
    counts_.longest_hold = std::max(counts_.longest_hold, end - last_solved_ - 1);
  }
  if (step.status == HVP_OK) last_solved_ = step.number;
}

void ServoProcess::deliver(const Step& step) {
  if (step.status == HVP_OK) work_.spend(Phase::force, 0, computation_.force_operations());
  held_force_ = step.force;
  // The device pushes back with what the user exerts on the body.
  write_force(-step.force);
}

void ServoProcess::advance(Step& step) {
  if (step.status != HVP_OK) return;
  solver_->finish(step.flags);
  computation_.update();
  updated_ = step.born;
  work_.spend(Phase::update, 0, computation_.update_operations());
}

void ServoProcess::publish(const Step& step) {
  access_.time().synchronise();
  SceneState& scene = exchange_.scene.prepare(now_ps());
  scene.tip = step.tip;
  scene.contact = step.contact;
  if (computation_.timing_only()) {
    // The body stays as the mailbox has had it from the beginning.
    exchange_.scene.publish(now_ps());
    return;
  }
  body_.expand(computation_.displacement(), scene.displacement);
  force_sum_ += step.force;
  ++force_frames_;
  scene.force = force_sum_ / static_cast<double>(force_frames_);
  exchange_.scene.publish(now_ps());
}

void ServoProcess::record(const Step& step) {
  Frame& frame = ledger_.frame(step.number);
  frame.contact_node = step.contact.node;
  frame.contact_age = step.contact.present() ? step.looked_up - step.report.pass_began : 0;
  frame.position = step.tip;
  frame.force = Eigen::Vector3d::Zero() - step.force;  // no negative zeros
  frame.solved = step.status == HVP_OK;
  frame.status = static_cast<int>(step.status);
  frame.flags = step.flags;
  counts_.flags |= step.flags;
  counts_.clamped_words += solver_->take_clamped_words();
}

void ServoProcess::observe(const Step& step) {
  const SolvedFrame view{step.number,         step.born - session_.begin,  step.tip,  step.contact,
                         computation_.held(), computation_.displacement(), step.force};
  for (FrameObserver* observer : observers_) observer->solved(view);
}

// Until the next tick, a piece after the other; one span for all of it.
void ServoProcess::recover(std::int64_t number) {
  if (recovery_.ready() || recovery_.given_up()) return;
  const Tag tag = access_.tag();
  access_.tag() = Tag{};
  access_.time().synchronise();
  const Picoseconds began = now_ps();
  const Picoseconds ticks = (began - session_.begin) / settings_.period;
  const Picoseconds until = session_.begin + (ticks + 1) * settings_.period;
  while (recovery_.work(number, until)) {
  }
  if (const hvp_status failed = recovery_.last_failure(); failed != HVP_OK) {
    note(failed, number);
    if (faults_ != nullptr) faults_->notice_failure(number);
  }
  counts_.recoveries = recovery_.recoveries();
  counts_.failed_set_ups = recovery_.failed_attempts();
  counts_.given_up_at = recovery_.given_up_at();
  if (recovery_.given_up()) {
    spdlog::error("the board was given up in frame {}: {}", number,
                  hvp_status_text(counts_.last_error));
  }
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
  const Frame& frame = ledger_.frame(step.number);
  const Picoseconds since =
      tag.cause == kBirth ? frame.born : frame.spans[static_cast<std::size_t>(tag.cause)].end;
  if (since == now_ps()) return;
  ledger_.extend(access_.tag(), Part::host, Phase::pipeline, since, now_ps());
}

Eigen::Vector3d ServoProcess::read_position() {
  const std::uint32_t latch = 1;
  access_.write(kDaqBase + DaqBoard::kLatch, &latch, sizeof(latch));
  std::array<std::int32_t, 3> counts{};
  access_.read(kDaqBase + DaqBoard::kPosition, counts.data(), sizeof(counts));
  return {plant::kPosition.to_value(counts[0]), plant::kPosition.to_value(counts[1]),
          plant::kPosition.to_value(counts[2])};
}

void ServoProcess::write_force(const Eigen::Vector3d& force) {
  std::array<std::int32_t, 3> counts{};
  bool clamped = false;
  for (int i = 0; i < 3; ++i) {
    const plant::Counts c = plant::kForce.to_counts(force[i]);
    counts[static_cast<std::size_t>(i)] = c.value;
    clamped = clamped || c.saturated;
  }
  if (clamped) ++counts_.clamped_forces;
  access_.write(kDaqBase + DaqBoard::kForce, counts.data(), sizeof(counts));
}

void ServoProcess::note(hvp_status status, std::int64_t frame) {
  if (status == HVP_OK) return;
  counts_.last_error = status;
  count(status, frame, 1);
}

void ServoProcess::count(hvp_status status, std::int64_t frame, std::int64_t times) {
  ErrorCount& error = counts_.errors[static_cast<std::size_t>(status)];
  if (times > 0 && error.count == 0) error.first_frame = frame;
  error.count += times;
}

}  // namespace hvp::vp
