#include "models/link/pcie_link.h"

#include <algorithm>
#include <string>

#include "models/config/input_error.h"

namespace hvp::link {

PcieLink::PcieLink(const Pcie& link, std::span<const PcieSide> initiators)
    : link_(link),
      byte_(byte_time(link.generation, link.lanes,
                      link.flits() ? kFlitTlpBytes : kFlitTlpAndDlpBytes)),
      dllp_interval_(link.dllp_interval_bytes()) {
  if (initiators.empty() || initiators.size() > kMaxInitiators) {
    throw InputError("a PCIe link of " + std::to_string(initiators.size()) + " initiators; 1 to " +
                     std::to_string(kMaxInitiators) + " are possible");
  }
  link_.check();
  const auto tags = static_cast<std::size_t>(link_.outstanding_reads);
  for (const PcieSide side : initiators) {
    Initiator initiator;
    initiator.side = side;
    state_.initiators.push_back(initiator);
  }
  state_.tags.resize(tags * initiators.size(), 0);
  for (Wire& wire : state_.wires) {
    wire.posted.entries.resize(static_cast<std::size_t>(link_.posted_header_credits));
    wire.nonposted.entries.resize(static_cast<std::size_t>(link_.nonposted_header_credits));
    wire.completions.resize(tags * initiators.size());
    // Apart from each other, and half an interval ahead, so that a short transfer pays its share.
    wire.next_ack = dllp_interval_ / 2;
    wire.next_credit = dllp_interval_;
    wire.next_skip = kSkipInterval / 2;
  }
  ahead_ = state_;
}

std::int64_t& PcieLink::tag(State& s, int initiator, std::int64_t number) const {
  return s.tags[static_cast<std::size_t>(initiator * link_.outstanding_reads +
                                         number % link_.outstanding_reads)];
}

std::int64_t PcieLink::tag(const State& s, int initiator, std::int64_t number) const {
  return s.tags[static_cast<std::size_t>(initiator * link_.outstanding_reads +
                                         number % link_.outstanding_reads)];
}

void PcieLink::request(int initiator, Direction direction, std::int64_t bytes, std::int64_t time_ps,
                       const CompleterTimes* times) {
  advance(time_ps);
  Initiator& i = of(state_, initiator);
  i.direction = direction;
  i.message = false;
  i.requested = time_ps;
  i.to_send = bytes;
  i.answers = 0;
  i.first = i.issued;
  i.times = times;
  i.sent = kNever;
  i.completed = kNever;
}

void PcieLink::message(int initiator, std::int64_t time_ps) {
  request(initiator, Direction::write, 1, time_ps);
  of(state_, initiator).message = true;
}

// A packet that could start at this very instant does not: another may still be requested.
void PcieLink::advance(std::int64_t time_ps) {
  while (step(state_, time_ps)) {
  }
  now_ = std::max(now_, time_ps);
}

void PcieLink::look_ahead() const {
  const auto copy_ring = [](const auto& from, auto& to, std::size_t first, std::size_t count) {
    for (std::size_t k = first; k < first + count; ++k) to[k % to.size()] = from[k % from.size()];
  };
  const auto copy_credits = [&](const Ring& from, Ring& to) {
    copy_ring(from.entries, to.entries, from.first, from.count);
    to.first = from.first;
    to.count = from.count;
    to.units = from.units;
  };
  for (std::size_t i = 0; i < state_.wires.size(); ++i) {
    const Wire& from = state_.wires[i];
    Wire& to = ahead_.wires[i];
    static_cast<WireState&>(to) = static_cast<const WireState&>(from);
    copy_credits(from.posted, to.posted);
    copy_credits(from.nonposted, to.nonposted);
    copy_ring(from.completions, to.completions, from.first, from.count);
  }
  ahead_.initiators = state_.initiators;
  ahead_.tags = state_.tags;
}

std::int64_t PcieLink::forecast(int initiator) const {
  look_ahead();
  while (of(ahead_, initiator).completed == kNever && step(ahead_, kNever)) {
  }
  return of(ahead_, initiator).completed;
}

std::int64_t PcieLink::forecast_sent(int initiator) const {
  look_ahead();
  while (of(ahead_, initiator).sent == kNever && step(ahead_, kNever)) {
  }
  return of(ahead_, initiator).sent;
}

std::int64_t PcieLink::credit(const Ring& ring, std::int64_t units, std::int64_t capacity) {
  std::int64_t time = 0;
  std::int64_t used = ring.units;
  std::size_t entries = ring.count;
  for (std::size_t k = 0; used + units > capacity || entries == ring.entries.size(); ++k) {
    const Credit& oldest = ring.entries[(ring.first + k) % ring.entries.size()];
    time = oldest.returned;
    used -= oldest.units;
    --entries;
  }
  return time;
}

void PcieLink::take(Ring& ring, std::int64_t now, Credit credit) {
  while (ring.count > 0 && ring.entries[ring.first].returned <= now) {
    ring.units -= ring.entries[ring.first].units;
    ring.first = (ring.first + 1) % ring.entries.size();
    --ring.count;
  }
  ring.entries[(ring.first + ring.count) % ring.entries.size()] = credit;
  ring.units += credit.units;
  ++ring.count;
}

// When the slot's next packet may start, the wire apart.
std::int64_t PcieLink::ready(const State& s, std::size_t wire, int slot) const {
  const Wire& w = s.wires[wire];
  if (slot == completion_slot()) return w.count == 0 ? kNever : w.completions[w.first].ready;
  const Initiator& i = of(s, slot);
  if (index(i.side) != wire || i.to_send == 0) return kNever;
  if (i.direction == Direction::write) {
    const std::int64_t payload = std::min<std::int64_t>(i.to_send, link_.max_payload_bytes);
    const std::int64_t units = i.message ? 0 : (payload + kCreditBytes - 1) / kCreditBytes;
    return std::max(i.requested, credit(w.posted, units, link_.posted_data_credits));
  }
  return std::max({i.requested, tag(s, slot, i.issued),
                   credit(w.nonposted, 1, link_.nonposted_header_credits)});
}

PcieLink::Start PcieLink::next(const State& s, std::size_t wire) const {
  Start start;
  const int slots = completion_slot() + 1;
  for (int k = 1; k <= slots; ++k) {
    const int slot = (s.wires[wire].last_slot + k) % slots;
    const std::int64_t time = std::max(s.wires[wire].free, ready(s, wire, slot));
    if (time < start.time) start = {time, slot};
  }
  return start;
}

// Sends the next packet of either direction if it starts before the given time.
bool PcieLink::step(State& s, std::int64_t before) const {
  const Start down = next(s, 0);
  const Start up = next(s, 1);
  const std::size_t wire = up.time < down.time ? 1 : 0;
  const Start& start = wire == 1 ? up : down;
  if (start.time >= before) return false;
  Wire& w = s.wires[wire];
  w.last_slot = start.slot;
  const bool completes = start.slot == completion_slot();
  const int initiator = completes ? w.completions[w.first].initiator : start.slot;
  if (completes) {
    send_completion(s, wire, start.time);
  } else if (of(s, start.slot).direction == Direction::write) {
    send_write(s, wire, start.slot, start.time);
  } else {
    send_request(s, wire, start.slot, start.time);
  }
  if (observer_ != nullptr && &s == &state_) {
    observer_->sent(wire == 0 ? PcieSide::root : PcieSide::device, initiator, start.time, w.free);
  }
  return true;
}

PcieLink::Sent PcieLink::send(Wire& wire, std::int64_t start, std::int64_t bytes) const {
  std::int64_t link_layer = 0;
  const auto due = [&](std::int64_t& next, std::int64_t interval, int size) {
    while (interval > 0 && wire.position + link_layer >= next) {
      link_layer += size;
      next += interval;
    }
  };
  due(wire.next_ack, dllp_interval_, kDllpBytes);
  due(wire.next_credit, dllp_interval_, kDllpBytes);
  due(wire.next_skip, kSkipInterval, kSkipBytes);
  const bool idle = start > wire.free;
  if (idle) wire.fraction = 0;
  const std::int64_t total = (link_layer + bytes) * byte_.numerator + wire.fraction;
  const std::int64_t end = start + total / byte_.denominator;
  wire.fraction = total % byte_.denominator;
  wire.position += link_layer + bytes;
  wire.traffic.packets += 1;
  wire.traffic.packet_bytes += bytes;
  wire.traffic.link_layer_bytes += link_layer;
  wire.traffic.busy_ps += end - start;
  wire.free = end;
  std::int64_t arrival = end + (wire.fraction > 0 ? 1 : 0);
  if (link_.flits()) {
    // The receiver checks a whole flit.
    wire.flit_fill = ((idle ? 0 : wire.flit_fill) + bytes) % kFlitTlpBytes;
    const std::int64_t rest = (kFlitTlpBytes - wire.flit_fill) % kFlitTlpBytes;
    arrival =
        end + (rest * byte_.numerator + wire.fraction + byte_.denominator - 1) / byte_.denominator;
  }
  return {end, arrival + link_.link_ps()};
}

void PcieLink::send_write(State& s, std::size_t wire, int initiator, std::int64_t start) const {
  Initiator& i = of(s, initiator);
  const std::int64_t payload = std::min<std::int64_t>(i.to_send, link_.max_payload_bytes);
  const Sent sent =
      send(s.wires[wire], start,
           i.message ? link_.message_wire_bytes() : payload + link_.write_header_bytes());
  const std::int64_t back = sent.end + 2 * link_.link_ps() + link_.credit_return_ps();
  const std::int64_t units = i.message ? 0 : (payload + kCreditBytes - 1) / kCreditBytes;
  take(s.wires[wire].posted, start, {back, units});
  i.to_send -= payload;
  if (i.to_send == 0) {
    i.sent = sent.end;
    i.completed = sent.arrival;
  }
}

void PcieLink::send_request(State& s, std::size_t wire, int initiator, std::int64_t start) const {
  Initiator& i = of(s, initiator);
  const std::int64_t bytes = std::min<std::int64_t>(i.to_send, link_.max_read_request_bytes);
  const Sent sent = send(s.wires[wire], start, link_.read_header_bytes());
  const std::int64_t back = sent.end + 2 * link_.link_ps() + link_.credit_return_ps();
  take(s.wires[wire].nonposted, start, {back, 1});
  tag(s, initiator, i.issued) = kNever;
  const std::int64_t completer =
      i.times == nullptr ? link_.completer_ps(i.side) : i.times->ps(i.issued - i.first);
  ++i.issued;
  ++i.answers;
  i.to_send -= bytes;
  if (i.to_send == 0) i.sent = sent.end;
  Wire& other = s.wires[1 - wire];
  other.completions[(other.first + other.count) % other.completions.size()] = {
      initiator, bytes, sent.arrival + completer};
  ++other.count;
}

void PcieLink::send_completion(State& s, std::size_t wire, std::int64_t start) const {
  Wire& w = s.wires[wire];
  Completion& c = w.completions[w.first];
  const std::int64_t payload = std::min<std::int64_t>(c.bytes, link_.completion_bytes());
  const Sent sent = send(w, start, payload + link_.completion_header_bytes());
  c.bytes -= payload;
  if (c.bytes > 0) return;
  Initiator& i = of(s, c.initiator);
  tag(s, c.initiator, i.answered) = sent.arrival;
  ++i.answered;
  --i.answers;
  if (i.answers == 0 && i.to_send == 0) i.completed = sent.arrival;
  w.first = (w.first + 1) % w.completions.size();
  --w.count;
}

}  // namespace hvp::link
