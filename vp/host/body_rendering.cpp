#include "vp/host/body_rendering.h"

#include <algorithm>

#include "models/time/picoseconds.h"
#include "vp/host/board_solver.h"
#include "vp/latency_draws.h"

namespace hvp::vp {

namespace {

// The solver without a board: the servo process solves, on its own core or on a GPU. Each step
// costs its operations as host.model prices them.
class HostSolver : public FrameSolver {
 public:
  // Keeps references.
  HostSolver(host::FrameComputation& computation, const Work& work, std::int64_t seed)
      : computation_(computation), work_(work) {
    const std::optional<host::Gpu>& gpu = work.costs().gpu;
    if (gpu && gpu->latencies) latencies_.emplace(*gpu->latencies, seed, "host.gpu.latencies");
  }

  hvp_status set_up_piece(bool& done) override {
    computation_.set_contact({});
    const host::FrameMethod& method = computation_.method();
    spend(Phase::solve, method.set_up_work(), method.memory().set_up);
    done = true;
    return HVP_OK;
  }
  hvp_status move_contact(std::span<const int> nodes) override {
    computation_.set_contact(nodes);
    const host::FrameMethod& method = computation_.method();
    spend(Phase::node_update, method.contact_work(), method.memory().working_set);
    return HVP_OK;
  }
  hvp_status begin(std::uint32_t& /*flags*/) override {
    goes_on_ = false;
    return HVP_OK;
  }
  hvp_status go_on(double way, std::uint32_t& /*flags*/) override {
    goes_on_ = true;
    way_ = way;
    return HVP_OK;
  }
  hvp_status end(std::uint32_t& /*flags*/) override {
    host::FrameMethod& method = computation_.method();
    if (goes_on_) {
      computation_.go_on(way_);
    } else {
      computation_.begin();
    }
    method.next({});
    if (const double operations = method.next_operations(); operations > 0) {
      work_.spend(Phase::refinement, 0, operations);
    }
    const double latency = latencies_ ? to_seconds(latencies_->next(work_.tag().frame)) : 0.0;
    work_.spend(Phase::solve,
                work_.costs().solve_s(method.solve_work(), method.memory()) + latency);
    return HVP_OK;
  }
  void finish(std::uint32_t& flags) override {
    host::FrameMethod& method = computation_.method();
    method.finish();
    if (const host::SolveWork rest = method.rest_work(); rest.operations() > 0) {
      spend(Phase::solve, rest, method.memory().working_set);
    }
    if (const double operations = method.finish_operations(); operations > 0) {
      work_.spend(Phase::refinement, 0, operations);
    }
    flags |= method.flags().bits();
  }
  hvp_status renew() override {
    const host::FrameMethod& method = computation_.method();
    const host::SolveMemory memory = method.memory();
    const host::SolveWork work = method.renew_work();
    if (work.operations() > 0) spend(Phase::assemble, work, memory.set_up);
    // A GPU gets what it solves with.
    if (const std::optional<host::Gpu>& gpu = work_.costs().gpu) {
      work_.spend(Phase::load_values, gpu->load_s(memory.kept));
    }
    return HVP_OK;
  }
  hvp_status close() override { return HVP_OK; }

 private:
  // On a core, with so many bytes touched.
  void spend(Phase phase, const host::SolveWork& work, double working_set) const {
    work_.spend(phase, work_.costs().core_solve_s(work, working_set));
  }

  host::FrameComputation& computation_;
  const Work& work_;
  std::optional<LatencyDraws> latencies_;
  bool goes_on_ = false;
  double way_ = 0;
};

std::unique_ptr<FrameSolver> make_solver(const BodySettings& settings,
                                         host::FrameComputation& computation,
                                         const DriverPort& port, const Work& work,
                                         HostMemory* memory) {
  if (!computation.has_board()) {
    return std::make_unique<HostSolver>(computation, work, settings.seed);
  }
  return std::make_unique<BoardSolver>(settings.solver, computation, port, work,
                                       settings.hold_saturated, memory);
}

}  // namespace

BodyRendering::BodyRendering(const BodySettings& settings, const SoftBody& soft, std::size_t probes,
                             BoardAccess& access, const DriverPort& port, const Work& work,
                             Exchange& exchange, HostMemory* memory)
    : settings_(settings),
      body_(soft.body),
      computation_(soft.computation),
      access_(access),
      work_(work),
      exchange_(exchange),
      contacts_(soft.contacts),
      solver_(make_solver(settings_, computation_, port, work, memory)),
      health_(settings_.costs.recovery, *solver_),
      held_(body_, soft.contacts, to_picoseconds(soft.contacts.settings().hand_over_s), probes),
      report_{{}, -1},
      forces_(held_.contacts().size(), Eigen::Vector3d::Zero()),
      force_sum_(forces_),
      tips_(probes, Eigen::Vector3d::Zero()),
      displacement_(body_.expand(computation_.displacement())) {
  if (soft.glide == nullptr) return;
  glides_.emplace(body_, *soft.glide, !computation_.timing_only());
  set_up_operations_ = soft.glide->set_up_operations();
  if (glides_->needs_solution()) computation_.expect_to_go_on();
}

BodyRendering::~BodyRendering() = default;

// Before the first frame there is time: a board that does not answer is asked again.
void BodyRendering::set_up() {
  access_.tag() = Tag{};
  const host::Recovery& policy = settings_.costs.recovery;
  for (int failed = 0;;) {
    bool done = false;
    hvp_status status = HVP_OK;
    while (status == HVP_OK && !done) status = solver_->set_up_piece(done);
    if (done) break;
    health_.set_up_failed(status, ++failed);
    sc_core::wait(to_sc_time(policy.back_off(failed) * settings_.period));
  }
  // The compliances of the surface are solved for by the host.
  if (glides_) work_.spend(Phase::contact, 0, set_up_operations_);
}

void BodyRendering::close(std::int64_t ticks) { health_.closed(solver_->close(), ticks); }

void BodyRendering::look(Frame& frame) {
  work_.spend(Phase::contact_lookup, settings_.costs.contact_lookup_s);
  access_.time().synchronise();
  if (contacts_.settings().fresh) return search(frame);
  const Picoseconds last_report = report_.pass_began;
  // A copy: the frame goes on while the next report arrives.
  report_ = exchange_.contact.read(now_ps());
  frame.contact_age = now_ps() - report_.pass_began;
  if (report_.pass_began == last_report) return;
  std::ranges::fill(force_sum_, Eigen::Vector3d::Zero());
  force_frames_ = 0;
}

// Searches as the collision process does, with the frame's own tips.
void BodyRendering::search(Frame& frame) {
  touches_ = frame.touches;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    touches_[i].contact = held_.contacts()[i];
    touches_[i].force = forces_[i];
  }
  body_.expand(computation_.displacement(), displacement_);
  const auto passes = glides_ ? contacts_.nearest(touches_, displacement_)
                      : computation_.timing_only()
                          ? contacts_.pass_without_force(touches_, displacement_)
                          : contacts_.pass(touches_, displacement_);
  report_.contacts.resize(passes.size());
  std::ranges::transform(passes, report_.contacts.begin(), &collision::Pass::contact);
  report_.pass_began = now_ps();
  frame.contact_age = 0;
}

void BodyRendering::begin(FrameStep& step) {
  Frame& frame = *step.frame;
  frame.status = health_.solver_status();
  step.attempted = frame.solved();
  if (step.attempted) {
    solver_->set_deadline(frame.born + (1 + settings_.costs.pipeline_depth) * settings_.period);
  }
  if (glides_) {
    begin_with_proxies(step);
  } else {
    begin_with_nodes(step);
  }
}

// The first solve is with the forces of the frame before; what they have to be now, its result
// tells.
void BodyRendering::begin_with_proxies(FrameStep& step) {
  Frame& frame = *step.frame;
  frame.contact_age = 0;
  if (!frame.solved()) return;
  health_.told_contact();
  std::ranges::transform(frame.touches, tips_.begin(), &collision::Touch::tip);
  glides_->suggest(report_.contacts);
  glides_->look(tips_, computation_.displacement());
  if (const double operations = glides_->look_operations(); operations > 0) {
    work_.spend(Phase::contact, 0, operations);
  }
  if (!glides_->needs_solution()) return;
  computation_.hold(glides_->hold());
  if (const double operations = computation_.hold_operations(); operations > 0) {
    work_.spend(Phase::hold, 0, operations);
  }
  frame.status = solver_->begin(frame.flags);
}

void BodyRendering::begin_with_nodes(FrameStep& step) {
  Frame& frame = *step.frame;
  if (step.attempted) {
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
void BodyRendering::move_contact(Frame& frame) {
  frame.status = solver_->move_contact(held_.nodes_of(report_.contacts));
  health_.told_contact();
  if (std::ranges::equal(report_.contacts, held_.contacts())) return;
  held_.change(report_.contacts, frame.born, frame.touches,
               {computation_.displacement(), computation_.velocity()});
}

void BodyRendering::collect(FrameStep& step) {
  Frame& frame = *step.frame;
  const bool solves = !glides_ || glides_->needs_solution();
  if (frame.solved() && solves) frame.status = solver_->end(frame.flags);
  health_.solve_ended({frame.number, frame.status, step.attempted}, frame.flags);
  if (glides_) {
    if (frame.solved()) {
      glides_->solve(computation_.displacement());
      work_.spend(Phase::contact, 0, glides_->solve_operations());
      std::ranges::copy(glides_->forces(), forces_.begin());
      frame.flags |= glides_->flags().bits();
    }
    for (std::size_t i = 0; i < forces_.size(); ++i) glides_->describe(i, frame.touches[i]);
  } else if (frame.solved()) {
    computation_.forces(forces_);
  }
  for (std::size_t i = 0; i < forces_.size(); ++i) frame.touches[i].force = forces_[i];
}

// Of the solution in words; a proxy's forces need none where the body's do not wait for a solve.
double BodyRendering::force_operations() const {
  return glides_ && !glides_->needs_solution() ? 0 : computation_.force_operations();
}

// Solves for the body under the forces that went out.
void BodyRendering::press(Frame& frame) {
  if (!glides_->changes()) return;
  computation_.hold(glides_->hold());
  if (const double operations = computation_.hold_operations(); operations > 0) {
    work_.spend(Phase::hold, 0, operations);
  }
  hvp_status status = glides_->needs_solution() ? solver_->go_on(glides_->way(), frame.flags)
                                                : solver_->begin(frame.flags);
  if (status == HVP_OK) status = solver_->end(frame.flags);
  if (status == HVP_OK) {
    glides_->apply();
    work_.spend(Phase::update, 0, computation_.force_operations());
    return;
  }
  computation_.hold(glides_->applied());
  health_.failed_after_force(status, frame.number, frame.flags);
}

void BodyRendering::advance(Frame& frame) {
  if (glides_) press(frame);
  solver_->finish(frame.flags);
  computation_.update();
  held_.solved(frame.born);
  work_.spend(Phase::update, 0, computation_.update_operations());
  if (computation_.renewal_is_due()) renew(frame);
}

// The next frame's increments are those of the body as it is deformed now.
void BodyRendering::renew(Frame& frame) {
  frame.flags |= computation_.renew().bits();
  work_.spend(Phase::assemble, 0, computation_.renew_operations());
  const hvp_status status = solver_->renew();
  if (status != HVP_OK) health_.failed_after_force(status, frame.number, frame.flags);
}

void BodyRendering::publish(const Frame& frame) {
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

void BodyRendering::note(const Frame& frame) {
  counts().flags |= frame.flags;
  counts().clamped_words += solver_->take_clamped_words();
}

}  // namespace hvp::vp
