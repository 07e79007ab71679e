#include "vp/function/outside_host.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "driver/hvp_bus.h"
#include "models/time/picoseconds.h"
#include "vp/bus/host_memory.h"
#include "vp/frame/frame_tag.h"
#include "vp/main_stack.h"

namespace hvp::vp {

LateInterrupts::LateInterrupts(const sc_core::sc_module_name& name, const host::Host& host,
                               std::int64_t seed, Ledger& ledger, Told told)
    : sc_module(name),
      latency_(to_picoseconds(host.interrupt_latency_s)),
      ledger_(ledger),
      told_(std::move(told)),
      due_("due") {
  if (host.interrupt_latencies) {
    draws_.emplace(*host.interrupt_latencies, seed, "host.interrupt_latencies");
  }
  SC_HAS_PROCESS(LateInterrupts);
  SC_METHOD(deliver);
  sensitive << due_;
  dont_initialize();
}

void LateInterrupts::raise(const Tag& tag, const Message& message) {
  const Picoseconds now = now_ps();
  Picoseconds due = now + (draws_ && tag.frame >= 0 ? draws_->next(tag.frame) : latency_);
  if (schedule_) due += schedule_->next();
  if (!under_way_.empty()) due = std::max(due, under_way_.back().due);
  under_way_.push_back({now, due, tag, message});
  due_.notify(to_sc_time(under_way_.front().due - now));
}

void LateInterrupts::forget_line() {
  std::erase_if(under_way_, [](const UnderWay& one) { return !one.message; });
}

void LateInterrupts::deliver() {
  if (now_ps() < held_until_) {
    due_.notify(to_sc_time(held_until_ - now_ps()));
    return;
  }
  while (!under_way_.empty() && under_way_.front().due <= now_ps()) {
    UnderWay one = under_way_.front();
    under_way_.pop_front();
    follow(one.tag, one.raised);
    told_(one.tag, one.message);
  }
  if (!under_way_.empty()) due_.notify(to_sc_time(under_way_.front().due - now_ps()));
}

// A host that polls may be through with the frame before its interrupt comes.
void LateInterrupts::follow(Tag& tag, Picoseconds raised) {
  if (now_ps() == raised || (tag.frame >= 0 && !ledger_.has(tag.frame))) return;
  ledger_.extend(tag, Part::host, Phase::interrupt, raised, now_ps());
}

namespace {

constexpr std::size_t kHostStackBytes = 1 << 20;  // a bus and a solve run on it
// No access takes so long: a day.
constexpr Picoseconds kForever = Picoseconds{86'400} * 1'000'000'000'000;

// As struct hvp_bus' take_errors returns them.
std::uint32_t driver_errors(const BusErrors& errors) {
  std::uint32_t all = 0;
  if (errors.master_abort) all |= HVP_BUS_MASTER_ABORT;
  if (errors.parity) all |= HVP_BUS_PARITY;
  return all;
}

FunctionSettings function_of(const PlatformSettings& settings) {
  FunctionSettings function{.bar_bytes = kBarBytes,
                            .messages = settings.transfer.notification == link::Notification::msi};
  if (settings.function) {
    function.wide_bar = settings.function->bar_bits == 64;
    if (settings.function->pci_express) function.express = settings.bus.pcie;
    function.message_table = settings.function->msi_x;
  }
  return function;
}

}  // namespace

OutsideHost::OutsideHost(const sc_core::sc_module_name& name, const PlatformSettings& settings,
                         BoardSide& side, Session& session, Ledger& ledger)
    : sc_module(name),
      side_(side),
      config_(function_of(settings)),
      access_("access"),
      frames_(ledger, session, access_.tag()),
      ledger_(ledger),
      seed_(settings.seed),
      longest_stall_s_(settings.longest_stall_s),
      posted_("posted") {
  if (side.board() == nullptr) throw std::invalid_argument("a host without a board");
  access_.to_bus.bind(side.from_host());
  side.connect(*this, [this] { return config_.messages_enabled(); });
  if (HostMemory* const memory = side.board()->memory()) {
    memory->answer_if([this] { return config_.may_master(); });
  }
  if (FaultPlan* const faults = side.board()->faults()) listen_to(*faults);
  frames_.watch(side.board()->accelerator());
  config_.on_change([this] { update_interrupts(); });
  config_.on_reset([this] { reset_function(); });
  SC_HAS_PROCESS(OutsideHost);
  SC_THREAD(serve);
  set_stack_size(kHostStackBytes);
}

void OutsideHost::post(Access access) {
  for (Observer* const observer : observers_) observer->asked(access);
  accesses_.push_back(std::move(access));
  posted_.notify(sc_core::SC_ZERO_TIME);
}

std::optional<std::int64_t> OutsideHost::begins_job(const Access& access) const {
  if (access.space != Space::bar || !config_.decodes()) return std::nullopt;
  JobFrames::Ahead ahead = frames_.ahead();
  for (std::size_t i = first_is_made_ ? 1 : 0; i < accesses_.size(); ++i) {
    const Access& before = accesses_[i];
    if (before.space == Space::bar) {
      ahead.follow(step_of(before.command, before.offset, before.data));
    }
  }
  const Step step = idle() ? frames_.step_now(access.command, access.offset, access.data)
                           : step_of(access.command, access.offset, access.data);
  return ahead.follow(step) ? std::optional(ahead.next - 1) : std::nullopt;
}

void OutsideHost::serve() {
  for (;;) {
    while (accesses_.empty()) wait(posted_);
    first_is_made_ = true;
    make(accesses_.front());
    if (removed() && !taken_away_) take_away();
    for (Observer* const observer : observers_) observer->ended(accesses_.front());
    const std::function<void()> ended = std::move(accesses_.front().ended);
    accesses_.pop_front();
    first_is_made_ = false;
    if (ended) ended();
    something_happened();
  }
}

void OutsideHost::configure(const Access& access) {
  side_.buses().drain_to_board();
  if (removed()) {
    if (access.command == Command::write) return;
    std::ranges::fill(access.data, std::uint8_t{0xff});
    if (access.space == Space::configuration &&
        ConfigSpace::reaches_errors(access.offset, access.data.size())) {
      frames_.told_by_bus(HVP_ERROR_BUS);
    }
    return;
  }
  if (access.space == Space::message_table) {
    if (access.command == Command::write) {
      config_.write_table(access.offset, access.data);
    } else {
      config_.read_table(access.offset, access.data);
      side_.buses().drain_to_host();
    }
    return;
  }
  if (shows_bus_errors_) note_bus_errors();
  if (access.command == Command::write) {
    config_.write(access.offset, access.data);
    return;
  }
  config_.read(access.offset, access.data);
  if (ConfigSpace::reaches_errors(access.offset, access.data.size())) {
    const std::uint32_t errors = driver_errors(config_.errors());
    if (errors != 0) frames_.told_by_bus(hvp_status_of_bus(errors));
  }
  side_.buses().drain_to_host();
}

void OutsideHost::listen_to(FaultPlan& faults) {
  faults.on_packet_error([this](FaultKind kind) { packet_error(kind); });
}

// The message of an error takes no time: no driver waits for it.
void OutsideHost::packet_error(FaultKind kind) {
  const bool corrected = kind == FaultKind::aer_correctable;
  const bool reported =
      config_.note(corrected ? ExpressError::bad_packet : ExpressError::poisoned_packet);
  if (reported && !corrected && listener_ != nullptr) listener_->error();
}

bool OutsideHost::removed() const {
  const FaultPlan* const faults = side_.board()->faults();
  return faults != nullptr && faults->removed();
}

// What was pulled out drives no line and has nothing pending.
void OutsideHost::take_away() {
  taken_away_ = true;
  pending_ = false;
  board_line_ = false;
  if (late_) late_->forget_all();
  update_interrupts();
}

void OutsideHost::note_bus_errors() {
  BusErrors& errors = side_.board()->bus_errors();
  if (errors.master_abort) config_.note(ConfigSpace::Error::master_abort);
  if (errors.parity) config_.note(ConfigSpace::Error::parity);
  errors = {};
}

void OutsideHost::make(const Access& access) {
  if (access.space != Space::bar) {
    configure(access);
    return;
  }
  const bool inside = access.offset <= kBarBytes && access.data.size() <= kBarBytes - access.offset;
  if (access.data.empty() || !inside || !config_.decodes()) {
    if (access.command == Command::read) std::ranges::fill(access.data, std::uint8_t{0xff});
    return;
  }
  frames_.before(access.command, access.offset, access.data);
  tell_of_births();
  const std::uint64_t address = kSolverBase + access.offset;
  if (access.command == Command::read) {
    access_.read(address, access.data.data(), access.data.size());
    frames_.answered(access.offset, access.data);
  } else {
    access_.write(address, access.data.data(), access.data.size());
  }
}

void OutsideHost::tell_of_births() {
  if (told_jobs_ == frames_.jobs()) return;
  told_jobs_ = frames_.jobs();
  for (Observer* const observer : observers_) observer->job_began(told_jobs_ - 1);
  tell_plan();
}

void OutsideHost::tell_plan() {
  FaultPlan* const faults = side_.board()->faults();
  if (faults != nullptr && told_jobs_ > 0) faults->born(told_jobs_ - 1, frames_.newest_birth());
}

void OutsideHost::inject(const Fault& fault) {
  FaultPlan& faults = side_.board()->plan_faults();
  listen_to(faults);
  faults.add(fault, told_jobs_);
  tell_plan();
}

bool OutsideHost::run_until(Picoseconds time) {
  if (held_ > 0) return true;
  happened_ = false;
  running_ = true;
  while (!happened_ && (now_ps() < time || sc_core::sc_pending_activity_at_current_time())) {
    if (now_ps() < time) {
      sc_core::sc_start(to_sc_time(time - now_ps()), sc_core::SC_RUN_TO_TIME);
    } else {
      sc_core::sc_start(sc_core::SC_ZERO_TIME);
    }
  }
  running_ = false;
  return_to_main_stack();
  return !happened_;
}

bool OutsideHost::access(Command command, std::uint64_t offset, std::span<std::uint8_t> data,
                         Space space) {
  if (held_ > 0) {
    if (command == Command::read) std::ranges::fill(data, std::uint8_t{0xff});
    return false;
  }
  bool ended = false;
  post({command, space, offset, data, [&ended] { ended = true; }});
  while (!ended) {
    if (run_until(now_ps() + kForever)) return false;
  }
  if (space != Space::bar) return true;
  const Picoseconds stalled = stall();
  if (stalled == 0) return true;
  const Picoseconds until = now_ps() + stalled;
  stands_still(until);
  while (now_ps() < until) run_until(until);
  stood_still();
  return true;
}

// A driver that polls finds then what has come meanwhile.
void OutsideHost::stood_still() {
  if (side_.board()->accelerator().bank().get(Register::interrupt_enable) == 0) {
    frames_.looked();
  } else {
    frames_.ran();
  }
  frames_.stood_still();
}

// Ends run_until() with this delta cycle.
void OutsideHost::something_happened() {
  if (!running_ || happened_) return;
  happened_ = true;
  sc_core::sc_pause();
}

void OutsideHost::take_interrupts_late(const host::Host& host, std::int64_t seed) {
  late_.emplace("late_interrupts", host, seed, ledger_,
                [this](const Tag& tag, const LateInterrupts::Message& message) {
                  frames_.heard(tag);
                  tell(message);
                });
}

// Now it is known whether the host takes its interrupts late anyway.
void OutsideHost::before_end_of_elaboration() {
  if (!longest_stall_s_) return;
  schedule_.emplace(seed_, "guest.schedule", *longest_stall_s_);
  if (!late_) {
    host::Host at_once;
    at_once.interrupt_latency_s = 0;
    take_interrupts_late(at_once, seed_);
  }
  late_->delay_by(RandomSchedule(seed_, "guest.schedule.interrupts", *longest_stall_s_));
}

void OutsideHost::tell(const LateInterrupts::Message& message) {
  if (!message) {
    tell_line(true);
    return;
  }
  ++messages_;
  for (Observer* const observer : observers_) observer->message(*message);
  if (listener_ == nullptr) return;
  listener_->message(*message);
  something_happened();
}

void OutsideHost::tell_line(bool up) {
  if (up) ++lines_;
  for (Observer* const observer : observers_) observer->line(up);
  if (listener_ != nullptr) listener_->line(up);
  something_happened();
}

void OutsideHost::raised(const Tag& tag, const LateInterrupts::Message& message) {
  if (late_) {
    late_->raise(tag, message);
  } else {
    tell(message);
  }
}

void OutsideHost::interrupt(const Tag& tag) {
  tag_ = tag;
  if (!late_) frames_.heard(tag);
  if (!config_.messages_enabled()) {
    board_line_ = true;
    if (!config_.may_raise_line()) {
      for (Observer* const observer : observers_) observer->line_blocked();
    }
  } else if (config_.message_masked()) {
    pending_ = true;
  } else {
    raised(tag, config_.message());
  }
  update_interrupts();
}

void OutsideHost::lowered() {
  board_line_ = false;
  update_interrupts();
}

// The host's view follows the board and the function's settings, whichever changed.
void OutsideHost::update_interrupts() {
  if (pending_ && config_.messages_enabled() && !config_.message_masked()) {
    pending_ = false;
    raised(tag_, config_.message());
  }
  config_.show_pending(pending_);
  config_.show_line(board_line_);
  const bool shown = board_line_ && config_.may_raise_line();
  if (shown == line_shown_) return;
  line_shown_ = shown;
  if (shown) {
    raised(tag_, std::nullopt);
    return;
  }
  if (late_) late_->forget_line();
  tell_line(false);
}

void OutsideHost::reset_function() {
  pending_ = false;
  if (late_) late_->forget_all();
  side_.board()->accelerator().power_on();
  frames_.board_was_reset();
  for (Observer* const observer : observers_) observer->board_was_reset();
  board_line_ = false;
  update_interrupts();
}

}  // namespace hvp::vp
