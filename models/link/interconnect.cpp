#include "models/link/interconnect.h"

#include <algorithm>

#include "models/time/picoseconds.h"

namespace hvp::link {

namespace {

std::int64_t words_of(std::int64_t bytes) { return (bytes + kWordBytes - 1) / kWordBytes; }

Cost repeated(const Cost& one, std::int64_t times) {
  return {one.latency_ps * times, one.processor_ps * times, one.bus_ps * times,
          one.wire_bytes * times, one.transactions * times};
}

}  // namespace

Cost& Cost::operator+=(const Cost& next) {
  latency_ps += next.latency_ps;
  processor_ps += next.processor_ps;
  bus_ps += next.bus_ps;
  wire_bytes += next.wire_bytes;
  transactions += next.transactions;
  return *this;
}

Cost operator+(Cost first, const Cost& next) { return first += next; }

PciInterconnect::PciInterconnect(const Pci& bus, const PciProtocol& protocol)
    : bus_(bus), clocks_(bus, protocol) {}

Cost PciInterconnect::block(Direction direction, std::int64_t bytes) const {
  const std::int64_t time = clocks_.alone_ps(direction, bytes);
  const std::int64_t phases = clocks_.phases(bytes);
  const std::int64_t bursts = (phases + clocks_.burst_phases() - 1) / clocks_.burst_phases();
  const std::int64_t attempts = clocks_.delays(direction) ? 1 + clocks_.retries_alone() : 1;
  return {time, 0, time, phases * bus_.width_bytes(), bursts * attempts};
}

Cost PciInterconnect::processor_write(std::int64_t bytes, bool combined) const {
  const std::int64_t unit = combined ? bus_.burst_bytes : kWordBytes;
  const std::int64_t stores = (bytes + unit - 1) / unit;
  const std::int64_t rest = bytes - (stores - 1) * unit;
  const Cost each = block(Direction::write, unit);
  const Cost last = block(Direction::write, rest);
  const std::int64_t gap = to_picoseconds(bus_.write_latency_s);
  const std::int64_t pace = std::max(gap, each.bus_ps);
  Cost cost = repeated(each, stores - 1) + last;
  cost.latency_ps = (stores - 1) * pace + gap + last.latency_ps;
  cost.processor_ps = (stores - 1) * pace + gap;
  return cost;
}

Cost PciInterconnect::processor_read(std::int64_t bytes) const {
  Cost each = block(Direction::read, kWordBytes);
  each.latency_ps += to_picoseconds(bus_.read_latency_s);
  each.processor_ps = each.latency_ps;
  return repeated(each, words_of(bytes));
}

Cost PciInterconnect::dma_read(std::int64_t bytes) const { return block(Direction::read, bytes); }

Cost PciInterconnect::dma_write(std::int64_t bytes) const { return block(Direction::write, bytes); }

Cost PciInterconnect::interrupt(Interrupt kind) const {
  return kind == Interrupt::msi ? dma_write(kWordBytes) : Cost{};
}

Cost PcieInterconnect::processor_write(std::int64_t bytes, bool combined) const {
  const std::int64_t unit = combined ? link_.write_combining_bytes : kWordBytes;
  const std::int64_t stores = (bytes + unit - 1) / unit;
  const std::int64_t rest = bytes - (stores - 1) * unit;
  const std::int64_t wire =
      link_.write_wire_bytes(unit) * (stores - 1) + link_.write_wire_bytes(rest);
  const std::int64_t gap = to_picoseconds(link_.write_gap_s);
  const std::int64_t pace = std::max(gap, link_.tlp_ps(link_.write_wire_bytes(unit)));
  Cost cost;
  cost.processor_ps = (stores - 1) * pace + gap;
  cost.latency_ps = (stores - 1) * pace + to_picoseconds(link_.processor_latency_s / 2) +
                    link_.posted_write_ps(rest);
  cost.bus_ps = link_.tlp_ps(wire);
  cost.wire_bytes = wire;
  cost.transactions = (stores - 1) * link_.packets(unit) + link_.packets(rest);
  return cost;
}

Cost PcieInterconnect::read(PcieSide requester, std::int64_t bytes) const {
  const std::int64_t request = link_.request_wire_bytes(bytes);
  const std::int64_t completion = link_.completion_wire_bytes(bytes);
  Cost cost;
  cost.latency_ps = link_.read_ps(requester, bytes);
  cost.bus_ps = link_.tlp_ps(std::max(request, completion));
  cost.wire_bytes = request + completion;
  cost.transactions = link_.requests(bytes) + link_.completions(bytes);
  return cost;
}

Cost PcieInterconnect::processor_read(std::int64_t bytes) const {
  Cost each = read(PcieSide::root, kWordBytes);
  each.latency_ps += to_picoseconds(link_.processor_latency_s);
  each.processor_ps = each.latency_ps;
  return repeated(each, words_of(bytes));
}

Cost PcieInterconnect::dma_read(std::int64_t bytes) const { return read(PcieSide::device, bytes); }

Cost PcieInterconnect::dma_write(std::int64_t bytes) const {
  const std::int64_t wire = link_.write_wire_bytes(bytes);
  return {link_.posted_write_ps(bytes), 0, link_.tlp_ps(wire), wire, link_.packets(bytes)};
}

Cost PcieInterconnect::interrupt(Interrupt kind) const {
  if (kind == Interrupt::msi) return dma_write(kWordBytes);
  const std::int64_t wire = link_.message_wire_bytes();
  return {link_.transfer_ps(wire) + link_.link_ps(), 0, link_.tlp_ps(wire), wire, 1};
}

}  // namespace hvp::link
