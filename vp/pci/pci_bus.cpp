#include "vp/pci/pci_bus.h"

#include <algorithm>
#include <cstring>

#include "vp/host/host_memory.h"

namespace hvp::vp {

namespace {

using link::Direction;

constexpr std::int64_t kWordBytes = 4;

std::int64_t bytes_of(const tlm::tlm_generic_payload& transaction) {
  return static_cast<std::int64_t>(transaction.get_data_length());
}

Direction direction_of(const tlm::tlm_generic_payload& transaction) {
  return transaction.is_read() ? Direction::read : Direction::write;
}

Phase processors_phase(Direction direction, std::int64_t bytes) {
  const bool block = bytes > kWordBytes;
  if (direction == Direction::read) return block ? Phase::block_read : Phase::bus_read;
  return block ? Phase::block_write : Phase::bus_write;
}

Phase boards_phase(tlm::tlm_generic_payload& transaction) {
  if (const std::optional<Phase> named = phase_of(transaction)) return *named;
  if (transaction.is_read()) return Phase::dma_read;
  return transaction.get_address() == kMessageAddress ? Phase::message : Phase::dma_write;
}

// A master abort, as the master sees it.
void abort(tlm::tlm_generic_payload& transaction) {
  transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  if (!transaction.is_read()) return;
  std::memset(transaction.get_data_ptr(), 0xff, transaction.get_data_length());
}

}  // namespace

PciBus::PciBus(const sc_core::sc_module_name& name, const link::Pci& model, bool untimed,
               Ledger& ledger)
    : sc_module(name),
      from_host("from_host"),
      from_board("from_board"),
      model_(model),
      untimed_(untimed),
      ledger_(ledger),
      to_targets_("to_targets"),
      to_memory_("to_memory") {
  from_host.register_b_transport(this, &PciBus::from_host_transport);
  from_board.register_b_transport(this, &PciBus::from_board_transport);
  use(kProcessor).name = "processor";
  use(kTraffic).name = "traffic";
  use(kBoard).name = "board";
  use(kGraphics).name = "graphics";
}

PciBus::PciBus(const sc_core::sc_module_name& name, const BusSettings& settings, Timing level,
               Ledger& ledger)
    : PciBus(name, settings.pci, level == Timing::untimed, ledger) {
  if (level != Timing::approximately_timed) return;
  arbiter_ = std::make_unique<link::PciArbiter>(
      settings.pci, settings.protocol.value_or(link::PciProtocol{}), kMasters);
}

void PciBus::attach(tlm::tlm_target_socket<>& target, std::uint64_t base, std::uint64_t size) {
  to_targets_.bind(target);
  windows_.push_back({base, size, static_cast<int>(windows_.size())});
}

void PciBus::attach_memory(tlm::tlm_target_socket<>& memory) {
  to_memory_.bind(memory);
  has_memory_ = true;
}

PciBus::Window* PciBus::claim(std::uint64_t address) {
  const auto hit = std::find_if(windows_.begin(), windows_.end(), [address](const Window& w) {
    return address >= w.base && address - w.base < w.size;
  });
  return hit == windows_.end() ? nullptr : &*hit;
}

void PciBus::from_host_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  Tag none;
  const Direction direction = direction_of(transaction);
  const std::int64_t bytes = bytes_of(transaction);
  const Picoseconds latency = direction == Direction::read ? model_.read_ps(0) : model_.write_ps(0);
  serve(tag_of(transaction, none),
        {kProcessor, direction, bytes, latency, processors_phase(direction, bytes)});
  reach_target(transaction);
}

void PciBus::reach_target(tlm::tlm_generic_payload& transaction) {
  const std::uint64_t address = transaction.get_address();
  const Window* window = claim(address);
  if (window == nullptr) {
    abort(transaction);
    return;
  }
  sc_core::sc_time held;
  transaction.set_address(address - window->base);
  to_targets_[window->target]->b_transport(transaction, held);
  transaction.set_address(address);
  keep_bus(kProcessor, static_cast<Picoseconds>(held.value()));
}

void PciBus::from_board_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  Tag none;
  serve(tag_of(transaction, none),
        {kBoard, direction_of(transaction), bytes_of(transaction), 0, boards_phase(transaction)});
  reach_memory(transaction);
}

void PciBus::reach_memory(tlm::tlm_generic_payload& transaction) {
  if (!has_memory_) {
    abort(transaction);
    return;
  }
  sc_core::sc_time held;
  to_memory_->b_transport(transaction, held);
  keep_bus(kBoard, static_cast<Picoseconds>(held.value()));
}

void PciBus::serve(Tag& tag, const Service& service) {
  if (arbiter_) {
    serve_in_bursts(tag, service);
  } else {
    serve_whole(tag, service);
    use(service.master).bytes += service.bytes;
    ++use(service.master).transactions;
  }
}

void PciBus::serve_whole(Tag& tag, const Service& service) {
  while (free_at_ > now_ps()) {
    const Picoseconds asked = now_ps();
    wait(to_sc_time(free_at_ - asked));
    ledger_.extend(tag, Part::bus, Phase::arbitration, asked, now_ps());
  }
  const bool read = service.direction == Direction::read;
  const Picoseconds wire =
      read ? model_.read_wire_ps(service.bytes) : model_.write_wire_ps(service.bytes);
  const Picoseconds time = untimed_ ? 0 : service.latency + wire;
  const Picoseconds start = now_ps();
  free_at_ = start + time;
  wait(to_sc_time(time));
  ledger_.extend(tag, Part::bus, service.phase, start, now_ps());
  use(service.master).busy += time;
}

// Waiting for the clock's edge and for others is spread over the bursts; the ledger has all of it
// in one span, before that of the transaction.
void PciBus::serve_in_bursts(Tag& tag, const Service& service) {
  const Picoseconds start = now_ps();
  bool& served = served_[static_cast<std::size_t>(service.master)];
  while (served) wait(changed_);
  served = true;
  const Picoseconds alone =
      service.latency + arbiter_->clocks().alone_ps(service.direction, service.bytes);
  wait(to_sc_time(service.latency));
  move(service.master, service.direction, service.bytes);
  served = false;
  changed_.notify();
  // A retried read can end sooner than it would alone: what another master moves in the meantime
  // shifts its attempts to where the target is just ready.
  const Picoseconds waited = std::max<Picoseconds>(0, now_ps() - start - alone);
  if (waited > 0) ledger_.extend(tag, Part::bus, Phase::arbitration, start, start + waited);
  ledger_.extend(tag, Part::bus, service.phase, start + waited, now_ps());
}

void PciBus::move(Master master, Direction direction, std::int64_t bytes) {
  arbiter_->request(master, direction, bytes, now_ps());
  changed_.notify();
  while (!arbiter_->done(master)) {
    wait(to_sc_time(arbiter_->forecast(master) - now_ps()), changed_);
    arbiter_->advance(now_ps());
  }
  use(master).bytes += bytes;
  ++use(master).transactions;
}

// Wait states that a target adds, with the bus.
void PciBus::keep_bus(Master master, Picoseconds time) {
  if (time == 0) return;
  if (arbiter_) {
    const Picoseconds before = arbiter_->held_ps();
    arbiter_->hold(now_ps() + time);
    use(master).busy += arbiter_->held_ps() - before;
    changed_.notify();
  } else {
    free_at_ = now_ps() + time;
    use(master).busy += time;
  }
  wait(to_sc_time(time));
}

BusUses PciBus::uses() const {
  BusUses uses(uses_.begin(), uses_.end());
  if (!arbiter_) return uses;
  for (int master = 0; master < kMasters; ++master) {
    uses[static_cast<std::size_t>(master)].busy += arbiter_->statistics(master).owned_ps;
  }
  return uses;
}

Picoseconds PciBus::busy() const {
  Picoseconds sum = 0;
  for (const BusUse& use : uses_) sum += use.busy;
  if (!arbiter_) return sum;
  for (int master = 0; master < kMasters; ++master) sum += arbiter_->statistics(master).owned_ps;
  return sum;
}

}  // namespace hvp::vp
