#include "vp/host/driver_port.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "vp/fpga/register_table.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// Keeps the ledger small when a block goes over the bus word by word: words that follow each other
// without a gap become one span, after one span of arbitration for all their waiting. Posted words
// keep their spans, because others may follow them.
class WordSpans {
 public:
  // The next words follow the tag. Keeps references.
  WordSpans(Ledger& ledger, Tag& tag) : ledger_(ledger), tag_(tag), before_(tag.cause) {}

  // To be called after each word.
  void fold();

 private:
  Ledger& ledger_;
  Tag& tag_;
  SpanId before_;  // the cause of the first word that is folded
};

namespace {

bool is_word(const Span& span) {
  return span.part == Part::bus &&
         (span.phase == Phase::bus_read || span.phase == Phase::bus_write);
}

bool may_be_folded(const Span& span) {
  return is_word(span) || (span.part == Part::bus && span.phase == Phase::arbitration);
}

}  // namespace

void WordSpans::fold() {
  if (tag_.frame < 0 || tag_.cause == before_) return;
  const std::vector<Span>& spans = ledger_.frame(tag_.frame).spans;
  const auto at = [&spans](SpanId id) -> const Span& {
    return spans[static_cast<std::size_t>(id)];
  };
  // The chain back to where the block stood, as long as it is the newest of the frame's spans.
  Picoseconds waited = 0;
  SpanId first = static_cast<SpanId>(spans.size());
  for (SpanId id = tag_.cause; id != before_; id = at(id).cause) {
    if (id != first - 1 || !may_be_folded(at(id))) {
      before_ = tag_.cause;  // somebody else's stand between: the next words begin anew
      return;
    }
    if (!is_word(at(id))) waited += at(id).end - at(id).start;
    first = id;
  }
  const Span last = at(tag_.cause);
  const Picoseconds start = at(first).start;
  ledger_.take_back(tag_, first);
  tag_.cause = before_;
  if (waited > 0) ledger_.extend(tag_, Part::bus, Phase::arbitration, start, start + waited);
  ledger_.extend(tag_, Part::bus, last.phase, start + waited, last.end);
}

namespace {
// A day. Picoseconds of longer waits would leave 64 bits before long.
constexpr std::uint64_t kLongestWaitNs = std::uint64_t{86'400} * 1'000'000'000;

DriverPort& self(void* context) { return *static_cast<DriverPort*>(context); }
}  // namespace

DriverPort::DriverPort(BoardAccess& access, Picoseconds interrupt_latency, Ledger& ledger,
                       Dispatcher* dispatcher, const Transfer& transfer)
    : access_(access),
      tag_(access.tag()),
      time_(access.time()),
      interrupt_latency_(interrupt_latency),
      ledger_(ledger),
      dispatcher_(dispatcher),
      transfer_(transfer) {
  bus_.context = this;
  bus_.read32 = [](void* context, std::uint32_t offset) noexcept {
    return self(context).read_register(offset);
  };
  bus_.write32 = [](void* context, std::uint32_t offset, std::uint32_t value) noexcept {
    self(context).access_.write(kSolverBase + offset, &value, sizeof(value));
  };
  bus_.read_block = [](void* context, std::uint32_t offset, std::uint32_t* words,
                       std::size_t count) noexcept {
    self(context).transport_block(tlm::TLM_READ_COMMAND, offset, words, count);
  };
  bus_.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                        std::size_t count) noexcept {
    // A write only reads them.
    self(context).transport_block(tlm::TLM_WRITE_COMMAND, offset, const_cast<std::uint32_t*>(words),
                                  count);
  };
  if (transfer_.notification == link::Notification::polling) {
    bus_.pause = [](void* context) noexcept { self(context).pause(); };
  } else {
    bus_.wait_interrupt = [](void* context, std::uint64_t timeout_ns) noexcept {
      return self(context).wait_interrupt(timeout_ns);
    };
  }
  bus_.interrupts_after_writes = transfer_.notification == link::Notification::msi;
  bus_.now_ns = [](void* context) noexcept {
    return static_cast<std::uint64_t>(self(context).time_.now() / 1000);
  };
}

void DriverPort::report_errors(BusErrors& errors, Picoseconds read_time, Picoseconds clear_time) {
  errors_ = &errors;
  error_read_time_ = read_time;
  error_clear_time_ = clear_time;
  bus_.take_errors = [](void* context) noexcept { return self(context).take_errors(); };
}

std::uint32_t DriverPort::take_errors() {
  time_.synchronise();
  const Picoseconds start = now_ps();
  sc_core::wait(to_sc_time(error_read_time_));
  ledger_.extend(tag_, Part::host, Phase::bridge_status, start, now_ps());
  std::uint32_t errors = 0;
  if (errors_->master_abort) errors |= HVP_BUS_MASTER_ABORT;
  if (errors_->parity) errors |= HVP_BUS_PARITY;
  if (errors == 0) return 0;
  const Picoseconds read = now_ps();
  sc_core::wait(to_sc_time(error_clear_time_));
  ledger_.extend(tag_, Part::host, Phase::bridge_status, read, now_ps());
  *errors_ = {};
  return errors;
}

bool DriverPort::by_words(tlm::tlm_command command) const {
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

void DriverPort::transport_block(tlm::tlm_command command, std::uint32_t offset,
                                 std::uint32_t* words, std::size_t count) {
  const std::uint64_t address = kSolverBase + offset;
  auto* const bytes = reinterpret_cast<unsigned char*>(words);
  const auto transport = [&](std::uint64_t place, unsigned char* data, std::size_t size) {
    if (command == tlm::TLM_READ_COMMAND) {
      access_.read(place, data, size);
    } else {
      access_.write(place, data, size);
    }
  };
  if (!by_words(command)) {
    transport(address, bytes, 4 * count);
    return;
  }
  WordSpans spans(ledger_, tag_);
  for (std::size_t i = 0; i < count; ++i) {
    transport(address + 4 * i, bytes + 4 * i, 4);
    spans.fold();
  }
}

// Looks in vain are one span, whatever they were.
std::uint32_t DriverPort::read_register(std::uint32_t offset) {
  std::uint32_t value = 0;
  const std::uint64_t address = kSolverBase + offset;
  const bool looks = transfer_.notification == link::Notification::polling && tag_.frame >= 0 &&
                     offset == kRegisters[static_cast<std::size_t>(Register::status)].offset;
  if (!looks) {
    access_.read(address, &value, sizeof(value));
    return value;
  }
  time_.synchronise();
  const Picoseconds since = now_ps();
  access_.look(address, &value, sizeof(value));
  note_looking(since, (value & (field::kStatusDone.mask() | field::kStatusError.mask())) != 0);
  return value;
}

void DriverPort::pause() {
  time_.synchronise();
  const Picoseconds since = now_ps();
  sc_core::wait(to_sc_time(to_picoseconds(transfer_.poll_interval_s)));
  // With DMA the record is in memory when the job has ended.
  note_looking(since, transfer_.method == Transfer::Method::dma);
}

// The processor has been looking from `since` until now. Once the board has answered, the frame
// follows the board, and what the look came later than the end is a span of its own.
void DriverPort::note_looking(Picoseconds since, bool may_have_ended) {
  if (tag_.frame < 0) return;
  const std::vector<Span>& spans = ledger_.frame(tag_.frame).spans;
  const Span* const last =
      tag_.cause == kBirth ? nullptr : &spans[static_cast<std::size_t>(tag_.cause)];
  const bool goes_on = last != nullptr && last->part == Part::host && last->end == since &&
                       (last->phase == Phase::wait || last->phase == Phase::polling);
  if (goes_on) {
    ledger_.prolong(tag_, now_ps());
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

int DriverPort::wait_interrupt(std::uint64_t timeout_ns) {
  time_.synchronise();
  const Picoseconds blocked = now_ps();
  const bool sleeps = !access_.has_interrupt();
  if (sleeps) {
    if (dispatcher_ != nullptr) dispatcher_->sleep();
    const auto timeout = static_cast<Picoseconds>(std::min(timeout_ns, kLongestWaitNs)) * 1000;
    while (!access_.has_interrupt() && now_ps() < blocked + timeout) {
      sc_core::wait(to_sc_time(blocked + timeout - now_ps()), access_.interrupted());
    }
    // A request of the same instant counts, whichever process the kernel runs first.
    if (!access_.has_interrupt()) sc_core::wait(sc_core::SC_ZERO_TIME);
    // The host's waiting is a span too, beside the board's.
    const SpanId waited = ledger_.add(tag_, Part::host, Phase::wait, blocked, now_ps());
    if (!access_.has_interrupt()) {
      tag_.cause = waited;
      if (dispatcher_ != nullptr) dispatcher_->wake(tag_);
      return HVP_INTERRUPT_TIMED_OUT;
    }
    // From here on the frame follows the board's spans, if the interrupt was for this frame.
    tag_.cause = waited;
    access_.follow_interrupt();
  }
  access_.take_interrupt();
  const Picoseconds requested = now_ps();
  sc_core::wait(to_sc_time(dispatcher_ == nullptr
                               ? interrupt_latency_
                               : dispatcher_->interrupt_latency(tag_.frame, interrupt_latency_)));
  ledger_.extend(tag_, Part::host, Phase::interrupt, requested, now_ps());
  if (sleeps && dispatcher_ != nullptr) dispatcher_->wake(tag_);
  return HVP_INTERRUPT;
}

}  // namespace hvp::vp
