#include "app/board/board_bus.h"

#include <algorithm>
#include <array>
#include <span>

#include "models/time/picoseconds.h"
#include "vp/bus/host_memory.h"

namespace hvp::app {

namespace {

using vp::Command;
using vp::ConfigSpace;
using vp::Picoseconds;

// The longest wait is a day; longer ones in picoseconds would soon exceed 64 bits.
constexpr std::uint64_t kLongestWaitNs = std::uint64_t{86'400} * 1'000'000'000;

// The COMMAND register and the bits that enable memory space and bus mastering.
constexpr std::uint64_t kCommandAt = 4;
constexpr std::uint8_t kMemorySpaceAndMaster = 6;

BoardBus& self(void* context) { return *static_cast<BoardBus*>(context); }

std::span<std::uint8_t> bytes_of(std::uint32_t* words, std::size_t count) {
  return {reinterpret_cast<std::uint8_t*>(words), 4 * count};
}

}  // namespace

BoardBus::BoardBus(vp::BoardFunction& function, const vp::Transfer& transfer)
    : function_(function), poll_interval_(to_picoseconds(transfer.poll_interval_s)) {
  function.host().listen(*this);
  bus_.context = this;
  bus_.read32 = [](void* context, std::uint32_t offset) noexcept {
    std::uint32_t value = 0;
    self(context).function_.host().access(Command::read, offset, bytes_of(&value, 1));
    return value;
  };
  bus_.write32 = [](void* context, std::uint32_t offset, std::uint32_t value) noexcept {
    self(context).function_.host().access(Command::write, offset, bytes_of(&value, 1));
  };
  bus_.read_block = [](void* context, std::uint32_t offset, std::uint32_t* words,
                       std::size_t count) noexcept {
    self(context).function_.host().access(Command::read, offset, bytes_of(words, count));
  };
  bus_.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                        std::size_t count) noexcept {
    // A write only reads the data.
    self(context).function_.host().access(Command::write, offset,
                                          bytes_of(const_cast<std::uint32_t*>(words), count));
  };
  if (transfer.notification == link::Notification::polling) {
    bus_.pause = [](void* context) noexcept {
      self(context).let_pass(self(context).poll_interval_);
    };
  } else {
    bus_.wait_interrupt = [](void* context, std::uint64_t timeout_ns) noexcept {
      return self(context).wait_interrupt(timeout_ns);
    };
  }
  bus_.interrupts_after_writes = transfer.notification == link::Notification::msi;
  bus_.now_ns = [](void*) noexcept { return static_cast<std::uint64_t>(vp::now_ps() / 1000); };
  // Takes no time, so that it is there for faults that come during the run too.
  bus_.take_errors = [](void* context) noexcept { return self(context).take_errors(); };
}

void BoardBus::enumerate() {
  // By the way of every other access, so that a record has these too.
  const auto write = [this](std::uint64_t offset, std::span<std::uint8_t> data) {
    function_.host().access(Command::write, offset, data, vp::OutsideHost::Space::configuration);
  };
  std::array<std::uint8_t, 1> command = {kMemorySpaceAndMaster};
  write(kCommandAt, command);
  if (function_.config().table_bytes() > 0) {
    enable_table();
    return;
  }
  // No effect if the function has no messages.
  std::array<std::uint8_t, 4> address = {0, 0, 0xe0, 0xfe};
  static_assert(vp::kMessageAddress == 0xfee0'0000);
  write(ConfigSpace::kMessageAt + 4, address);
  std::array<std::uint8_t, 1> enable = {1};
  write(ConfigSpace::kMessageAt + 2, enable);
}

// Unmasks the one vector of MSI-X and switches it on.
void BoardBus::enable_table() {
  std::array<std::uint8_t, 16> entry = {0, 0, 0xe0, 0xfe};
  for (std::size_t at = 0; at < entry.size(); at += 4) {
    function_.host().access(Command::write, at, std::span(entry).subspan(at, 4),
                            vp::OutsideHost::Space::message_table);
  }
  std::array<std::uint8_t, 2> enable = {0, 0x80};
  function_.host().access(Command::write, ConfigSpace::kMessageTableAt + 2, enable,
                          vp::OutsideHost::Space::configuration);
}

bool BoardBus::take_interrupt() {
  const bool up = function_.host().line_is_up() || message_;
  message_ = false;
  if (up) function_.host().frames().took();
  return up;
}

int BoardBus::wait_interrupt(std::uint64_t timeout_ns) {
  const Picoseconds late =
      vp::now_ps() + static_cast<Picoseconds>(std::min(timeout_ns, kLongestWaitNs)) * 1000;
  while (!take_interrupt()) {
    const bool reached = function_.host().run_until(late);
    function_.host().frames().looked();
    if (reached) {
      return take_interrupt() ? HVP_INTERRUPT : HVP_INTERRUPT_TIMED_OUT;
    }
  }
  return HVP_INTERRUPT;
}

std::uint32_t BoardBus::take_errors() {
  // What the function itself notes is asked for in its configuration space, behind the writes that
  // are on their way to it.
  const bool asks_function = function_.config().bytes() == ConfigSpace::kExpressBytes;
  if (asks_function) {
    std::array<std::uint8_t, 4> identity{};
    function_.host().access(Command::read, 0, identity, vp::OutsideHost::Space::configuration);
  }
  vp::BusErrors& noted = function_.bus_errors();
  std::uint32_t errors = 0;
  if (noted.master_abort) errors |= HVP_BUS_MASTER_ABORT;
  if (noted.parity) errors |= HVP_BUS_PARITY;
  noted = {};
  if (errors != 0) function_.host().frames().told_by_bus(hvp_status_of_bus(errors));
  // The wait for that answer is the job's, as for that of a read of the BAR.
  if (asks_function) function_.host().frames().before(Command::read, 0, {});
  return errors;
}

void BoardBus::let_pass(Picoseconds time) {
  const Picoseconds end = vp::now_ps() + time;
  while (!function_.host().run_until(end)) continue;
  function_.host().frames().looked();
}

}  // namespace hvp::app
