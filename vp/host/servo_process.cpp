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
#include "vp/host/driver_config.h"

namespace hvp::vp {

namespace {
constexpr std::size_t kStackBytes = 1 << 20;  // the C driver runs on it
// A touch begins with displacements below any word's unit; after so many frames it has not.
constexpr int kFramesWithoutWords = 16;
}  // namespace

ServoProcess::ServoProcess(const sc_core::sc_module_name& name, const ServoSettings& settings,
                           const fem::Body& body, host::FrameComputation& computation,
                           const collision::ContactSearch& contacts, BoardAccess& access,
                           Dispatcher& dispatcher, Exchange& exchange, Ledger& ledger,
                           Verdict& verdict, Session& session)
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
      b_(computation.displacement().size()),
      u_(computation.displacement().size()) {
  scratch_.resize(std::max<std::size_t>(HVP_MIN_SCRATCH_WORDS, b_.size()));
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
  if (!set_up()) {
    // Without a frame no miss would be counted, and the run would look like one that held.
    throw std::runtime_error(std::string("the board could not be set up: ") +
                             hvp_status_text(counts_.last_error));
  }
  set_up_time_ = now_ps() - began;
  session_.begin = now_ps();
  begun_.notify(sc_core::SC_ZERO_TIME);
  std::int64_t number = 0;
  while (number < settings_.frames) {
    frame(number);
    ++number;
    // A tick that has passed entirely while the process was at work had no frame.
    while (number < settings_.frames &&
           now_ps() >= session_.begin + (number + 1) * settings_.period) {
      verdict_.skip_tick();
      ++number;
    }
  }
  access_.tag() = Tag{};
  // What went wrong before says more than that a lost board cannot be closed.
  const hvp_status closed = hvp_close(&device_);
  if (counts_.last_error == HVP_OK) note(closed);
  sc_core::sc_stop();
}

bool ServoProcess::set_up() {
  access_.tag() = Tag{};
  const hvp_solver_config config = driver_config(settings_.solver);
  const fixed::QuantisedMatrix& k = computation_.quantised();
  const hvp_matrix matrix{static_cast<std::uint32_t>(k.block_rows()),
                          static_cast<std::uint32_t>(k.column.size()), k.row_begin.data(),
                          k.column.data(), k.value.data()};
  // Whatever the board had been told of a contact went with its matrix.
  contact_ = {};
  computation_.set_contact({});

  hvp_status status = hvp_open(&device_, &access_.solver_bus(), scratch_.data(), scratch_.size());
  if (status == HVP_OK) status = hvp_configure(&device_, &config);
  if (status == HVP_OK) status = hvp_load_matrix(&device_, &matrix);
  if (status == HVP_OK && config.start != HVP_START_FROM_ZERO) {
    computation_.scaling().displacement_words(computation_.displacement(), u_);
    status = hvp_write_initial_guess(&device_, u_.data(), u_.size());
  }
  note(status);
  return status == HVP_OK;
}

// A process that is still at work at its tick goes on; one that slept has to be woken.
void ServoProcess::release(std::int64_t number) {
  const Picoseconds born = session_.begin + number * settings_.period;
  const Picoseconds released = born + dispatcher_.release_delay(number);
  const bool sleeps = now_ps() < released;
  if (sleeps) {
    dispatcher_.sleep();
    wait(to_sc_time(released - now_ps()));
  }
  ledger_.open(number, born);
  access_.tag() = Tag{number, kBirth};
  ledger_.extend(access_.tag(), Part::host, Phase::release, born, now_ps());
  if (sleeps) dispatcher_.wake(access_.tag());
}

void ServoProcess::frame(std::int64_t number) {
  release(number);
  const Picoseconds born = ledger_.frame(number).born;

  const Eigen::Vector3d tip = read_position();

  spend(Phase::contact_lookup, settings_.costs.contact_lookup_s);
  // A copy: the frame goes on while the next report arrives.
  const ContactReport report = exchange_.contact.read(now_ps());
  const Picoseconds looked_up = now_ps();
  if (report.pass_began != last_report_) {
    last_report_ = report.pass_began;
    force_sum_.setZero();
    force_frames_ = 0;
  }
  hvp_status status = HVP_OK;
  if (!(report.contact == contact_)) {
    if (report.contact.present()) {
      const std::span<const int> patch = contacts_.patch(report.contact.node);
      next_contact_.clear();
      for (const int node : patch) next_contact_.push_back(body_.active_index(node));
    } else {
      next_contact_.clear();
    }
    status = move_contact(next_contact_);
    contact_ = report.contact;
    ++counts_.contact_changes;
    if (contact_.present()) take_over(born, tip);
  }

  Eigen::Vector3d u_c = Eigen::Vector3d::Zero();
  if (contact_.present()) {
    u_c = contacts_.prescribed_displacement(contact_, tip) + hand_over_.gap(born);
  }
  std::uint32_t frame_flags = 0;
  Eigen::Vector3d force = held_force_;
  if (status == HVP_OK) {
    status = find_displacement(u_c, frame_flags);
  }
  if (status == HVP_OK) {
    force = computation_.force();
    spend(Phase::force, 0, computation_.force_operations());
  } else {
    frame_flags |= std::uint32_t{1} << static_cast<unsigned>(stability::Flag::solver_timeout);
    note(status);
    ++counts_.driver_errors;
  }
  held_force_ = force;
  // The device pushes back with what the user exerts on the body.
  write_force(-force);

  if (status == HVP_OK) {
    if (computation_.refined() != nullptr) {
      judge_refinement(*computation_.refined(), frame_flags);
    }
    computation_.update();
    spend(Phase::update, 0, computation_.update_operations());
  }

  SceneState& scene = exchange_.scene.prepare(now_ps());
  scene.tip = tip;
  body_.expand(computation_.displacement(), scene.displacement);
  scene.contact = contact_;
  force_sum_ += force;
  ++force_frames_;
  scene.force = force_sum_ / static_cast<double>(force_frames_);
  exchange_.scene.publish(now_ps());

  Frame& record = ledger_.frame(number);
  record.contact_node = contact_.node;
  record.contact_age = contact_.present() ? looked_up - report.pass_began : 0;
  record.position = tip;
  record.force = Eigen::Vector3d::Zero() - force;  // no negative zeros
  record.solved = status == HVP_OK;
  record.flags = frame_flags;
  counts_.flags |= frame_flags;
  const SolvedFrame view{
      number, born - session_.begin,       tip,  contact_.node, computation_.contact(),
      u_c,    computation_.displacement(), force};
  for (FrameObserver* observer : observers_) observer->solved(view);

  // The last safe force is out; now the board is brought back, for as long as that takes.
  if (status != HVP_OK && !set_up()) {
    spdlog::error("the board did not come back: {}", hvp_status_text(counts_.last_error));
  }
  ledger_.frame(number).work_done = now_ps();
  ledger_.close(number);
}

Eigen::Vector3d ServoProcess::read_position() {
  const std::uint32_t latch = 1;
  access_.write(kDaqBase + DaqBoard::kLatch, &latch, sizeof(latch));
  std::array<std::int32_t, 3> counts{};
  access_.read(kDaqBase + DaqBoard::kPosition, counts.data(), sizeof(counts));
  return {plant::kPosition.to_value(counts[0]), plant::kPosition.to_value(counts[1]),
          plant::kPosition.to_value(counts[2])};
}

// The new contact node is where the last solution left it, and on its way to the tip from now on.
void ServoProcess::take_over(Picoseconds now, const Eigen::Vector3d& tip) {
  const auto first = static_cast<std::size_t>(3 * body_.active_index(contact_.node));
  const Eigen::Vector3d displacement(&computation_.displacement()[first]);
  hand_over_.begin(now, std::llround(contacts_.settings().hand_over_s * 1e12),
                   displacement - contacts_.prescribed_displacement(contact_, tip));
}

// Nodes that were let go get their rows back before others are taken, so that the board's matrix
// is K but for the rows and columns of `nodes`.
hvp_status ServoProcess::move_contact(std::span<const int> nodes) {
  const fixed::QuantisedMatrix& k = computation_.quantised();
  const std::vector<int>& present = computation_.contact();
  const auto stays = [&nodes](int node) {
    return std::binary_search(nodes.begin(), nodes.end(), node);
  };
  const auto held = [&present](int node) {
    return std::binary_search(present.begin(), present.end(), node);
  };
  hvp_status status = HVP_OK;
  for (const int node : present) {
    if (stays(node) || status != HVP_OK) continue;
    const std::span<const std::int32_t> row = k.row(node);
    row_.assign(row.begin(), row.end());
    // The board must be told zeros towards nodes that are still cleared there: those that stay
    // in contact, and those whose turn comes later, which bring the blocks back by symmetry.
    const auto first = static_cast<std::size_t>(k.row_begin[static_cast<std::size_t>(node)]);
    for (std::size_t i = 0; i < row_.size() / 9; ++i) {
      const int other = k.column[first + i];
      if (held(other) && (stays(other) || other > node)) {
        std::fill_n(row_.begin() + static_cast<std::ptrdiff_t>(9 * i), 9, 0);
      }
    }
    status = hvp_restore_node(&device_, static_cast<std::uint32_t>(node), row_.data(),
                              static_cast<std::uint32_t>(row_.size() / 9));
  }
  for (const int node : nodes) {
    if (held(node) || status != HVP_OK) continue;
    status = hvp_constrain_node(&device_, static_cast<std::uint32_t>(node),
                                computation_.diagonal_word());
  }
  computation_.set_contact(nodes);
  return status;
}

// U of this frame, in words or refined.
hvp_status ServoProcess::find_displacement(const Eigen::Vector3d& u_c, std::uint32_t& flags) {
  if (computation_.refined() != nullptr) return refine(u_c, *computation_.refined());
  const int clamped = computation_.form_rhs(u_c, b_);
  spend(Phase::form_rhs, 0, computation_.form_rhs_operations());
  counts_.clamped_words += clamped;
  if (clamped > 0) {
    flags |= std::uint32_t{1} << static_cast<unsigned>(stability::Flag::range_exceeded);
  }
  const hvp_status status = solve();
  if (status != HVP_OK) return status;
  flags |= hvp_last_flags(&device_);
  // Words that are too coarse leave nothing of the load: the board solves A·x = 0 without a flag.
  const bool vanished =
      u_c.squaredNorm() > 0 && std::ranges::all_of(b_, [](int w) { return w == 0; });
  frames_without_words_ = vanished ? frames_without_words_ + 1 : 0;
  if (frames_without_words_ >= kFramesWithoutWords) {
    flags |= std::uint32_t{1} << static_cast<unsigned>(stability::Flag::stagnation);
  }
  computation_.accept(u_);
  return status;
}

// Each pass' residual follows the increment of the pass before in one span; the last increment has
// one of its own.
hvp_status ServoProcess::refine(const Eigen::Vector3d& u_c, host::RefinedSolve& refined) {
  computation_.begin_passes(u_c);
  double operations = refined.begin_operations();
  while (refined.next(b_)) {
    spend(Phase::refinement, 0, operations + refined.next_operations());
    if (const hvp_status status = solve(); status != HVP_OK) {
      refined.abandon();
      return status;
    }
    refined.accept(u_, stability::Flags(hvp_last_flags(&device_)));
    operations = refined.accept_operations();
  }
  spend(Phase::refinement, 0, operations + refined.next_operations());
  return HVP_OK;
}

// What is left of the residual is known when the next frame's product is formed: after the force.
void ServoProcess::judge_refinement(host::RefinedSolve& refined, std::uint32_t& flags) {
  refined.finish();
  spend(Phase::refinement, 0, refined.finish_operations());
  flags |= refined.flags().bits();
  counts_.clamped_words += refined.clamped();
}

hvp_status ServoProcess::solve() {
  spend(Phase::driver, settings_.costs.driver_call_s);
  hvp_status status = hvp_write_rhs(&device_, b_.data(), b_.size());
  if (status == HVP_OK) status = hvp_start(&device_);
  if (status != HVP_OK) return status;
  status = hvp_wait(&device_, static_cast<std::uint64_t>(settings_.costs.timeout_s * 1e9));
  if (status != HVP_OK) return status;
  spend(Phase::driver, settings_.costs.driver_call_s);
  return hvp_read_solution(&device_, u_.data(), u_.size());
}

void ServoProcess::write_force(const Eigen::Vector3d& force) {
  std::array<std::int32_t, 3> counts{};
  for (int i = 0; i < 3; ++i) {
    const plant::Counts c = plant::kForce.to_counts(force[i]);
    counts[static_cast<std::size_t>(i)] = c.value;
    if (c.saturated) ++counts_.clamped_words;
  }
  access_.write(kDaqBase + DaqBoard::kForce, counts.data(), sizeof(counts));
}

void ServoProcess::spend(Phase phase, double seconds, double operations) {
  if (settings_.untimed) return;
  const Picoseconds start = now_ps();
  wait(to_sc_time(std::llround(seconds * 1e12) + settings_.costs.compute_ps(operations)));
  ledger_.extend(access_.tag(), Part::host, phase, start, now_ps());
}

void ServoProcess::note(hvp_status status) {
  if (status != HVP_OK) counts_.last_error = status;
}

}  // namespace hvp::vp
