#include "vp/host/board_access.h"

#include <algorithm>

namespace hvp::vp {

namespace {
// A day. Picoseconds of longer waits would leave 64 bits before long.
constexpr std::uint64_t kLongestWaitNs = std::uint64_t{86'400} * 1'000'000'000;

BoardAccess& self(void* context) { return *static_cast<BoardAccess*>(context); }
}  // namespace

BoardAccess::BoardAccess(const sc_core::sc_module_name& name, Picoseconds interrupt_latency,
                         Ledger& ledger, Dispatcher* dispatcher)
    : sc_module(name),
      to_bus("to_bus"),
      interrupt_latency_(interrupt_latency),
      ledger_(ledger),
      dispatcher_(dispatcher),
      raised_("raised") {
  extension_.tag = &tag_;
  payload_.set_extension(&extension_);
  payload_.set_byte_enable_ptr(nullptr);
  solver_bus_.context = this;
  solver_bus_.read32 = [](void* context, std::uint32_t offset) noexcept {
    std::uint32_t value = 0;
    self(context).read(kSolverBase + offset, &value, sizeof(value));
    return value;
  };
  solver_bus_.write32 = [](void* context, std::uint32_t offset, std::uint32_t value) noexcept {
    self(context).write(kSolverBase + offset, &value, sizeof(value));
  };
  solver_bus_.read_block = [](void* context, std::uint32_t offset, std::uint32_t* words,
                              std::size_t count) noexcept {
    self(context).read(kSolverBase + offset, words, 4 * count);
  };
  solver_bus_.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                               std::size_t count) noexcept {
    self(context).write(kSolverBase + offset, words, 4 * count);
  };
  solver_bus_.wait_interrupt = [](void* context, std::uint64_t timeout_ns) noexcept {
    return self(context).wait_interrupt(timeout_ns);
  };
  solver_bus_.now_ns = [](void* context) noexcept {
    return static_cast<std::uint64_t>(self(context).time_.now() / 1000);
  };
}

BoardAccess::~BoardAccess() { payload_.clear_extension(&extension_); }

bool BoardAccess::write(std::uint64_t address, const void* data, std::size_t bytes) {
  // A payload's data pointer is not const, though a write only reads it.
  return transport(tlm::TLM_WRITE_COMMAND, address,
                   const_cast<unsigned char*>(static_cast<const unsigned char*>(data)), bytes);
}

bool BoardAccess::read(std::uint64_t address, void* data, std::size_t bytes) {
  return transport(tlm::TLM_READ_COMMAND, address, static_cast<unsigned char*>(data), bytes);
}

bool BoardAccess::transport(tlm::tlm_command command, std::uint64_t address, unsigned char* data,
                            std::size_t bytes) {
  payload_.set_command(command);
  payload_.set_address(address);
  payload_.set_data_ptr(data);
  payload_.set_data_length(static_cast<unsigned>(bytes));
  payload_.set_streaming_width(static_cast<unsigned>(bytes));
  payload_.set_dmi_allowed(false);
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  sc_core::sc_time delay = time_.ahead();
  to_bus->b_transport(payload_, delay);
  wait(delay);
  time_.restart();
  return payload_.is_response_ok();
}

void BoardAccess::interrupt(const Tag& tag) {
  if (!line_up_) interrupt_tag_ = tag;
  line_up_ = true;
  raised_.notify(sc_core::SC_ZERO_TIME);
}

void BoardAccess::follow_interrupt() {
  if (line_up_ && interrupt_tag_.frame == tag_.frame) tag_.cause = interrupt_tag_.cause;
}

void BoardAccess::lowered() { line_up_ = false; }

int BoardAccess::wait_interrupt(std::uint64_t timeout_ns) {
  time_.synchronise();
  const Picoseconds blocked = now_ps();
  const bool sleeps = !line_up_;
  if (sleeps) {
    if (dispatcher_ != nullptr) dispatcher_->sleep();
    const auto timeout = static_cast<Picoseconds>(std::min(timeout_ns, kLongestWaitNs)) * 1000;
    while (!line_up_ && now_ps() < blocked + timeout) {
      wait(to_sc_time(blocked + timeout - now_ps()), raised_);
    }
    // A request of the same instant counts, whichever process the kernel runs first.
    if (!line_up_) wait(sc_core::SC_ZERO_TIME);
    // What the host does not do meanwhile is a span too, beside the board's.
    const SpanId waited = ledger_.add(tag_, Part::host, Phase::wait, blocked, now_ps());
    if (!line_up_) {
      tag_.cause = waited;
      if (dispatcher_ != nullptr) dispatcher_->wake(tag_);
      return HVP_INTERRUPT_TIMED_OUT;
    }
    // From here on the frame follows what the board did.
    if (interrupt_tag_.frame == tag_.frame) {
      tag_.cause = interrupt_tag_.cause;
    } else {
      tag_.cause = waited;
    }
  }
  const Picoseconds requested = now_ps();
  wait(to_sc_time(interrupt_latency_));
  ledger_.extend(tag_, Part::host, Phase::interrupt, requested, now_ps());
  if (sleeps && dispatcher_ != nullptr) dispatcher_->wake(tag_);
  return HVP_INTERRUPT;
}

}  // namespace hvp::vp
