#include "app/serve/board_port.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "app/board/outside_board.h"

namespace hvp::serve {

namespace {

// Events closer together than this are simulated without looking at the socket in between, which
// costs as much as some of them.
constexpr vp::Picoseconds kPiece = 20'000'000;  // 20 us

}  // namespace

BoardPort::BoardPort(const vp::PlatformSettings& settings, results::RegisterTrace* registers,
                     vp::DriverRules* rules)
    : board_(settings, rules != nullptr ? static_cast<vp::AccessObserver*>(rules) : registers),
      has_messages_(settings.transfer.notification == link::Notification::msi) {
  board_.host().listen(*this);
  board_.host().show_bus_errors();
  if (vp::HostMemory* const memory = board_.memory()) {
    memory->answer_if([this] {
      if (look_at_memory_) look_at_memory_();
      return board_.config().may_master();
    });
  }
  if (registers != nullptr) registers->watch(board_.accelerator());
  if (rules != nullptr) app::watch_driver(*rules, board_);
  vp::BoardSide::step_to(0);
}

void BoardPort::tell(Interrupts* interrupts) {
  interrupts_ = interrupts;
  if (interrupts_ != nullptr) interrupts_->line(line_is_up());
}

bool BoardPort::busy() { return board_.accelerator().bank().get(vp::field::kStatusBusy) != 0; }

bool BoardPort::has_work() {
  if (commands_ != nullptr && commands_->stopped()) return false;
  const std::optional<vp::Picoseconds> next = vp::BoardSide::next_event();
  return next && *next <= (busy() ? last_access_ + kLongest : awake_until_);
}

void BoardPort::advance() {
  const std::optional<vp::Picoseconds> next = vp::BoardSide::next_event();
  if (!next) return;
  const bool was_busy = busy();
  board_.host().run_until(std::max(*next, vp::now_ps() + kPiece));
  if (was_busy) awake_until_ = std::min(vp::now_ps() + kSettle, last_access_ + kLongest);
}

void BoardPort::accessed() {
  last_access_ = vp::now_ps();
  awake_until_ = last_access_ + kSettle;
}

void BoardPort::read_config(std::uint64_t offset, std::span<std::uint8_t> data) {
  board_.host().access(vp::Command::read, offset, data, vp::OutsideHost::Space::configuration);
}

void BoardPort::write_config(std::uint64_t offset, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> copy(data.begin(), data.end());
  board_.host().access(vp::Command::write, offset, copy, vp::OutsideHost::Space::configuration);
  accessed();
}

bool BoardPort::read_bar(std::uint64_t offset, std::span<std::uint8_t> data) {
  const bool answered = board_.host().access(vp::Command::read, offset, data);
  accessed();
  return answered;
}

bool BoardPort::write_bar(std::uint64_t offset, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> copy(data.begin(), data.end());
  const bool answered = board_.host().access(vp::Command::write, offset, copy);
  accessed();
  return answered;
}

void BoardPort::read_table(std::uint64_t offset, std::span<std::uint8_t> data) {
  board_.host().access(vp::Command::read, offset, data, vp::OutsideHost::Space::message_table);
}

void BoardPort::write_table(std::uint64_t offset, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> copy(data.begin(), data.end());
  board_.host().access(vp::Command::write, offset, copy, vp::OutsideHost::Space::message_table);
  accessed();
}

// As an operating system does that finds memory space off: it is on for as long as that takes.
void BoardPort::mask_message(bool masked) {
  constexpr std::uint64_t kCommandAt = 4;
  std::array<std::uint8_t, 2> before{};
  read_config(kCommandAt, before);
  std::array<std::uint8_t, 2> with_memory = before;
  with_memory[0] |= 2U;
  if (with_memory != before) write_config(kCommandAt, with_memory);
  const std::array<std::uint8_t, 4> control = {static_cast<std::uint8_t>(masked ? 1 : 0)};
  write_table(vp::MessageTable::kControlAt, control);
  if (with_memory != before) write_config(kCommandAt, before);
}

std::uint64_t BoardPort::bar_bytes() const { return vp::kBarBytes; }

void BoardPort::map(std::uint64_t address, std::span<std::uint8_t> memory, bool writable) {
  if (vp::HostMemory* const host = board_.memory()) host->map(address, memory, writable);
}

void BoardPort::unmap(std::uint64_t address, std::uint64_t bytes) {
  if (vp::HostMemory* const host = board_.memory()) host->unmap(address, bytes);
}

// Resets the function through its own capability, as software does.
void BoardPort::reset() {
  const vp::ConfigSpace::ResetByte byte = board_.config().reset_byte();
  write_config(byte.offset, std::array{byte.value});
}

void BoardPort::message(const vp::ConfigSpace::Message& /*message*/) {
  if (interrupts_ != nullptr) interrupts_->message();
}

void BoardPort::error() {
  if (interrupts_ != nullptr) interrupts_->error();
}

void BoardPort::line(bool up) {
  if (interrupts_ != nullptr) interrupts_->line(up);
}

}  // namespace hvp::serve
