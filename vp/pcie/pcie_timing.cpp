#include "vp/pcie/pcie_timing.h"

#include <algorithm>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

namespace {

using link::Direction;
using link::PcieSide;

PcieSide other(PcieSide side) { return side == PcieSide::root ? PcieSide::device : PcieSide::root; }

}  // namespace

PcieTiming::PcieTiming(const link::Pcie& link, Timing level, const Ledger& ledger)
    : link_(link), untimed_(level == Timing::untimed), ledger_(ledger) {
  link_.check();
  if (level != Timing::approximately_timed) return;
  std::array<PcieSide, kSenders> sides{};
  for (int i = 0; i < kSenders; ++i) {
    sides[static_cast<std::size_t>(i)] = side(static_cast<Sender>(i));
  }
  packets_.emplace(link_, sides);
  packets_->report_to(*this);
}

Picoseconds PcieTiming::send(Sender sender, std::int64_t bytes, Errand errand) {
  if (untimed_) return now_ps();
  errands_[static_cast<std::size_t>(sender)] = errand;
  if (!packets_) return send_by_formula(sender, bytes);
  if (bytes == 0) {
    packets_->message(sender, now_ps());
  } else {
    packets_->request(sender, Direction::write, bytes, now_ps());
  }
  changed_.notify();
  until_sent(sender);
  return packets_->completed_ps(sender);
}

void PcieTiming::ask(Sender sender, std::int64_t bytes, Errand errand,
                     const link::CompleterTimes* times) {
  if (untimed_) return;
  errands_[static_cast<std::size_t>(sender)] = errand;
  if (!packets_) {
    ask_by_formula(sender, bytes, times);
    return;
  }
  packets_->request(sender, Direction::read, bytes, now_ps(), times);
  changed_.notify();
  until_sent(sender);
  wait_until(packets_->sent_ps(sender) + link_.link_ps());
}

void PcieTiming::await_answer(Sender sender) {
  if (untimed_) return;
  if (!packets_) {
    wait_until(answered_[static_cast<std::size_t>(sender)]);
    return;
  }
  packets_->advance(now_ps());
  while (!packets_->done(sender)) {
    sc_core::wait(to_sc_time(packets_->forecast(sender) - now_ps()), changed_);
    packets_->advance(now_ps());
  }
}

void PcieTiming::sent(PcieSide sender, int initiator, Picoseconds start, Picoseconds end) {
  if (!ledger_.takes_tenures()) return;
  const bool processors = initiator == kProcessorWrites || initiator == kProcessorReads;
  const Errand& errand = errands_[static_cast<std::size_t>(initiator)];
  ledger_.take({sender == PcieSide::root ? Resource::link_to_board : Resource::link_to_host,
                processors ? "processor" : "board", name(errand.phase), errand.frame, start, end});
}

Picoseconds PcieTiming::busy(PcieSide sender) const {
  return packets_ ? packets_->traffic(sender).busy_ps : busy_[index(sender)];
}

void PcieTiming::until_sent(Sender sender) {
  while (packets_->sent_ps(sender) > now_ps()) {
    sc_core::wait(to_sc_time(packets_->forecast_sent(sender) - now_ps()), changed_);
    packets_->advance(now_ps());
  }
}

Picoseconds PcieTiming::send_by_formula(Sender sender, std::int64_t bytes) {
  Picoseconds& free = free_at(side(sender));
  const Picoseconds start = std::max(now_ps(), free);
  const Picoseconds time = bytes == 0
                               ? link_.transfer_ps(link_.message_wire_bytes()) + link_.link_ps()
                               : link_.posted_write_ps(bytes);
  free = start + time - link_.link_ps();
  const Picoseconds packets =
      link_.tlp_ps(bytes == 0 ? link_.message_wire_bytes() : link_.write_wire_bytes(bytes));
  busy_[index(side(sender))] += packets;
  sent(side(sender), sender, start, start + packets);
  wait_until(free);
  return start + time;
}

// The completions begin when the side that is read has the data and its direction is free.
void PcieTiming::ask_by_formula(Sender sender, std::int64_t bytes,
                                const link::CompleterTimes* times) {
  const PcieSide here = side(sender);
  Picoseconds& requests_free = free_at(here);
  Picoseconds& completions_free = free_at(other(here));
  const Picoseconds start = std::max(now_ps(), requests_free);
  const Picoseconds arrival =
      start + link_.transfer_ps(link_.read_header_bytes()) + link_.link_ps();
  const Picoseconds ready = arrival + (times == nullptr ? link_.completer_ps(here) : times->ps(0));
  const Picoseconds delay = std::max<Picoseconds>(0, completions_free - ready);
  const Picoseconds alone =
      times == nullptr ? link_.read_ps(here, bytes) : link_.read_ps(here, bytes, *times);
  const Picoseconds end = start + alone + delay;
  const Picoseconds requests = link_.tlp_ps(link_.request_wire_bytes(bytes));
  const Picoseconds completions = link_.tlp_ps(link_.completion_wire_bytes(bytes));
  busy_[index(here)] += requests;
  busy_[index(other(here))] += completions;
  requests_free = start + requests;
  completions_free = end - link_.link_ps();
  sent(here, sender, start, requests_free);
  sent(other(here), sender, completions_free - completions, completions_free);
  answered_[static_cast<std::size_t>(sender)] = end;
  wait_until(arrival);
}

}  // namespace hvp::vp
