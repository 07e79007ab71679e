#include "vp/host/board_access.h"

#include <algorithm>
#include <cmath>

#include "vp/fpga/register_table.h"
#include "vp/host/word_spans.h"

namespace hvp::vp {

namespace {
// A day. Picoseconds of longer waits would leave 64 bits before long.
constexpr std::uint64_t kLongestWaitNs = std::uint64_t{86'400} * 1'000'000'000;

BoardAccess& self(void* context) { return *static_cast<BoardAccess*>(context); }
}  // namespace

BoardAccess::BoardAccess(const sc_core::sc_module_name& name, Picoseconds interrupt_latency,
                         Ledger& ledger, Dispatcher* dispatcher, const Transfer& transfer)
    : sc_module(name),
      to_bus("to_bus"),
      transfer_(transfer),
      interrupt_latency_(interrupt_latency),
      ledger_(ledger),
      dispatcher_(dispatcher),
      raised_("raised") {
  extension_.tag = &tag_;
  payload_.set_extension(&extension_);
  payload_.set_byte_enable_ptr(nullptr);
  solver_bus_.context = this;
  solver_bus_.read32 = [](void* context, std::uint32_t offset) noexcept {
    return self(context).read_register(offset);
  };
  solver_bus_.write32 = [](void* context, std::uint32_t offset, std::uint32_t value) noexcept {
    self(context).write(kSolverBase + offset, &value, sizeof(value));
  };
  solver_bus_.read_block = [](void* context, std::uint32_t offset, std::uint32_t* words,
                              std::size_t count) noexcept {
    self(context).transport_block(tlm::TLM_READ_COMMAND, offset, words, count);
  };
  solver_bus_.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                               std::size_t count) noexcept {
    // A write only reads them.
    self(context).transport_block(tlm::TLM_WRITE_COMMAND, offset, const_cast<std::uint32_t*>(words),
                                  count);
  };
  if (transfer_.notification == link::Notification::polling) {
    solver_bus_.pause = [](void* context) noexcept { self(context).pause(); };
  } else {
    solver_bus_.wait_interrupt = [](void* context, std::uint64_t timeout_ns) noexcept {
      return self(context).wait_interrupt(timeout_ns);
    };
  }
  solver_bus_.interrupts_after_writes = transfer_.notification == link::Notification::msi;
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

void BoardAccess::report_errors(BusErrors& errors, Picoseconds read_time, Picoseconds clear_time) {
  errors_ = &errors;
  error_read_time_ = read_time;
  error_clear_time_ = clear_time;
  solver_bus_.take_errors = [](void* context) noexcept { return self(context).take_errors(); };
}

std::uint32_t BoardAccess::take_errors() {
  time_.synchronise();
  const Picoseconds start = now_ps();
  wait(to_sc_time(error_read_time_));
  ledger_.extend(tag_, Part::host, Phase::bridge_status, start, now_ps());
  std::uint32_t errors = 0;
  if (errors_->master_abort) errors |= HVP_BUS_MASTER_ABORT;
  if (errors_->parity) errors |= HVP_BUS_PARITY;
  if (errors == 0) return 0;
  const Picoseconds read = now_ps();
  wait(to_sc_time(error_clear_time_));
  ledger_.extend(tag_, Part::host, Phase::bridge_status, read, now_ps());
  *errors_ = {};
  return errors;
}

bool BoardAccess::by_words(tlm::tlm_command command) const {
  switch (transfer_.method) {
    case Transfer::Method::bursts:
    case Transfer::Method::dma:
      return false;
    case Transfer::Method::programmed_io:
      return true;
    case Transfer::Method::write_combined_io:
      return command == tlm::TLM_READ_COMMAND;
  }
  return false;
}

void BoardAccess::transport_block(tlm::tlm_command command, std::uint32_t offset,
                                  std::uint32_t* words, std::size_t count) {
  const std::uint64_t address = kSolverBase + offset;
  auto* const bytes = reinterpret_cast<unsigned char*>(words);
  if (!by_words(command)) {
    transport(command, address, bytes, 4 * count);
    return;
  }
  WordSpans spans(ledger_, tag_);
  for (std::size_t i = 0; i < count; ++i) {
    transport(command, address + 4 * i, bytes + 4 * i, 4);
    spans.fold();
  }
}

std::uint32_t BoardAccess::read_register(std::uint32_t offset) {
  std::uint32_t value = 0;
  const bool looks = transfer_.notification == link::Notification::polling && tag_.frame >= 0 &&
                     offset == kRegisters[static_cast<std::size_t>(Register::status)].offset;
  if (looks) {
    poll_status(value);
  } else {
    read(kSolverBase + offset, &value, sizeof(value));
  }
  return value;
}

// Looks in vain are one span, whatever they were.
void BoardAccess::poll_status(std::uint32_t& status) {
  time_.synchronise();
  const Picoseconds since = now_ps();
  Tag nothing;
  extension_.tag = &nothing;
  extension_.unseen_frame = tag_.frame;
  read(kSolverBase + kRegisters[static_cast<std::size_t>(Register::status)].offset, &status,
       sizeof(status));
  extension_.tag = &tag_;
  extension_.unseen_frame.reset();
  note_looking(since, (status & (field::kStatusDone.mask() | field::kStatusError.mask())) != 0);
}

void BoardAccess::pause() {
  time_.synchronise();
  const Picoseconds since = now_ps();
  wait(to_sc_time(std::llround(transfer_.poll_interval_s * 1e12)));
  // With DMA the record is in memory when the job has ended.
  note_looking(since, transfer_.method == Transfer::Method::dma);
}

// The processor has been looking from `since` until now. Once the board has answered, the frame
// follows the board, and what the look came later than the end is a span of its own.
void BoardAccess::note_looking(Picoseconds since, bool may_have_ended) {
  if (tag_.frame < 0) return;
  std::vector<Span>& spans = ledger_.frame(tag_.frame).spans;
  Span* const last = tag_.cause == kBirth ? nullptr : &spans[static_cast<std::size_t>(tag_.cause)];
  const bool goes_on = last != nullptr && last->part == Part::host && last->end == since &&
                       (last->phase == Phase::wait || last->phase == Phase::polling);
  if (goes_on) {
    last->end = now_ps();
    if (last->phase == Phase::polling) return;
  } else {
    looking_since_ = since;
    ledger_.extend(tag_, Part::host, Phase::wait, since, now_ps());
  }
  if (!may_have_ended || job_end_ == nullptr || job_end_->tag.frame != tag_.frame ||
      job_end_->time <= looking_since_) {
    return;
  }
  tag_.cause = job_end_->tag.cause;
  ledger_.extend(tag_, Part::host, Phase::polling, job_end_->time, now_ps());
}

// A message is taken by the wait that it ends; a line stays up until the board lowers it.
void BoardAccess::interrupt(const Tag& tag) {
  if (!line_up_ || messages()) interrupt_tag_ = tag;
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
  if (messages()) line_up_ = false;
  const Picoseconds requested = now_ps();
  wait(to_sc_time(dispatcher_ == nullptr
                      ? interrupt_latency_
                      : dispatcher_->interrupt_latency(tag_.frame, interrupt_latency_)));
  ledger_.extend(tag_, Part::host, Phase::interrupt, requested, now_ps());
  if (sleeps && dispatcher_ != nullptr) dispatcher_->wake(tag_);
  return HVP_INTERRUPT;
}

}  // namespace hvp::vp
