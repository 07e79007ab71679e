#include "app/record/player.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <systemc>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "vp/fpga/register_table.h"

namespace hvp::record {

namespace {

// Where something is awaited, events closer together than this are simulated at once.
constexpr Picoseconds kPiece = 20'000'000;  // 20 us

}  // namespace

Player::Player(vp::BoardFunction& function, const Record& recorded, std::string_view file,
               Inject inject)
    : Recorder([this](const Entry& entry) { replayed_ += compose(entry); }),
      function_(function),
      recorded_(recorded),
      file_(file),
      inject_(std::move(inject)),
      replayed_(compose_head(recorded.layer(), "")),
      memory_(recorded) {
  // As the three layers do it.
  if (recorded.layer() != Layer::program) function.host().show_bus_errors();
  watch(function);
  if (recorded.layer() == Layer::socket) vp::BoardSide::step_to(0);
}

Record Player::play() {
  for (const Entry& entry : recorded_.entries()) {
    switch (entry.kind) {
      case Kind::asked:
        ask(entry);
        break;
      case Kind::ended:
        ++ends_awaited_;
        break;
      case Kind::message:
      case Kind::line:
        ++interrupts_awaited_;
        break;
      case Kind::map:
      case Kind::unmap:
        change_memory(entry);
        break;
      case Kind::fault:
        inject(entry);
        break;
      case Kind::memory_read:
      case Kind::memory_write:
      case Kind::missing:
      case Kind::end:
        break;
    }
  }
  wait_for(recorded_.last());
  note_end();
  return parse_record(std::move(replayed_), "the replay");
}

void Player::ask(const Entry& entry) {
  wait_for(entry.time);
  if (entry.has(kSettled)) let_pass_what_is_due();
  for (; data_.size() > asked_ - accesses_ended(); data_.pop_front()) continue;
  ++asked_;
  std::vector<std::uint8_t>& data = data_.emplace_back(entry.bytes);
  std::ranges::copy(entry.data, data.begin());
  using Space = vp::OutsideHost::Space;
  const Space space = entry.has(kConfiguration) ? Space::configuration
                      : entry.has(kTable)       ? Space::message_table
                                                : Space::bar;
  function_.host().post(
      {entry.has(kWrite) ? vp::Command::write : vp::Command::read, space, entry.address, data, {}});
}

void Player::change_memory(const Entry& entry) {
  wait_for(entry.time);
  vp::HostMemory* const memory = function_.memory();
  if (memory == nullptr) return;  // the board of this scenario is no bus master
  if (entry.kind == Kind::unmap) {
    const std::uint64_t bytes = number_in(entry);
    if (memory->unmap(entry.address, bytes)) memory_.forget(entry.address, bytes);
    return;
  }
  try {
    memory->map(entry.address, memory_.add(entry.address, number_in(entry)), entry.has(kWritable));
  } catch (const std::invalid_argument& e) {
    throw InputError(fmt::format("{}: byte {}: {} bytes of memory at {:#x}: {}", file_, entry.at,
                                 number_in(entry), entry.address, e.what()));
  }
}

void Player::inject(const Entry& entry) {
  wait_for(entry.time);
  const std::string words(entry.data.begin(), entry.data.end());
  try {
    inject_(words);
  } catch (const InputError& e) {
    throw InputError(
        fmt::format("{}: byte {}: the fault that was asked for: {}", file_, entry.at, e.what()));
  }
  note_fault(words);
}

void Player::to_be_moved(bool read, std::uint64_t address, std::size_t bytes) {
  if (!read) return;
  memory_.prepare(address, bytes);
}

bool Player::waits() const {
  return (!hangs_ && accesses_ended() < ends_awaited_) ||
         interrupts() + missing_ < interrupts_awaited_;
}

bool Player::busy() { return function_.accelerator().bank().get(vp::field::kStatusBusy) != 0; }

bool Player::in_vain(Picoseconds since) {
  const Picoseconds now = vp::now_ps();
  if (busy()) last_busy_ = now;
  if (!vp::BoardSide::next_event()) return true;
  return now - since > kLongest || now - std::max(last_busy_, since) > kSettle;
}

void Player::wait_for(Picoseconds time) {
  while (vp::now_ps() < time) function_.host().run_until(time);
  const Picoseconds since = vp::now_ps();
  while (waits()) {
    const std::optional<Picoseconds> next = vp::BoardSide::next_event();
    if (next) function_.host().run_until(std::max(*next, vp::now_ps() + kPiece));
    if (!waits() || !in_vain(since)) continue;
    for (; interrupts() + missing_ < interrupts_awaited_; ++missing_) note_missing();
    // An access that has no end keeps those behind it from theirs.
    if (!vp::BoardSide::next_event() || vp::now_ps() - since > kLongest) hangs_ = waits();
  }
}

void Player::let_pass_what_is_due() {
  while (sc_core::sc_pending_activity_at_current_time()) {
    function_.host().run_until(vp::now_ps());
  }
}

}  // namespace hvp::record
