#include "vp/pci/pci_bus.h"

#include <algorithm>
#include <cstring>

namespace hvp::vp {

PciBus::PciBus(const sc_core::sc_module_name& name, const link::Pci& model, bool untimed,
               Ledger& ledger)
    : sc_module(name),
      from_host("from_host"),
      model_(model),
      untimed_(untimed),
      ledger_(ledger),
      to_targets_("to_targets") {
  from_host.register_b_transport(this, &PciBus::b_transport);
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

PciBus::Window* PciBus::claim(std::uint64_t address) {
  const auto hit = std::find_if(windows_.begin(), windows_.end(), [address](const Window& w) {
    return address >= w.base && address - w.base < w.size;
  });
  return hit == windows_.end() ? nullptr : &*hit;
}

void PciBus::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  Tag none;
  Tag& tag = tag_of(transaction, none);

  const bool read = transaction.is_read();
  const auto bytes = static_cast<std::int64_t>(transaction.get_data_length());
  const bool block = bytes > 4;
  const Phase phase = read ? (block ? Phase::block_read : Phase::bus_read)
                           : (block ? Phase::block_write : Phase::bus_write);
  if (arbiter_) {
    serve_in_bursts(tag, phase, read ? link::Direction::read : link::Direction::write, bytes);
  } else {
    serve_whole(tag, phase, untimed_ ? 0 : read ? model_.read_ps(bytes) : model_.write_ps(bytes));
  }
  ++transactions_;
  bytes_ += bytes;

  Window* window = claim(transaction.get_address());
  if (window == nullptr) {
    transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    if (read) {
      std::memset(transaction.get_data_ptr(), 0xff, static_cast<std::size_t>(bytes));
    }
    return;
  }
  const std::uint64_t address = transaction.get_address();
  transaction.set_address(address - window->base);
  to_targets_[window->target]->b_transport(transaction, delay);
  transaction.set_address(address);
  // Wait states of the target keep the bus.
  const auto held = static_cast<Picoseconds>(delay.value());
  if (held > 0) hold(held);
  delay = sc_core::SC_ZERO_TIME;
}

void PciBus::serve_whole(Tag& tag, Phase phase, Picoseconds time) {
  while (free_at_ > now_ps()) {
    const Picoseconds asked = now_ps();
    wait(to_sc_time(free_at_ - asked));
    ledger_.extend(tag, Part::bus, Phase::arbitration, asked, now_ps());
  }
  const Picoseconds start = now_ps();
  free_at_ = start + time;
  wait(to_sc_time(time));
  ledger_.extend(tag, Part::bus, phase, start, now_ps());
  busy_ += time;
}

// Waiting for the clock's edge and for others is spread over the bursts; the ledger has all of it
// in one span, before that of the transaction.
void PciBus::serve_in_bursts(Tag& tag, Phase phase, link::Direction direction, std::int64_t bytes) {
  const Picoseconds start = now_ps();
  while (processor_served_) wait(changed_);
  processor_served_ = true;
  const bool read = direction == link::Direction::read;
  const Picoseconds latency = read ? model_.read_ps(0) : model_.write_ps(0);
  const Picoseconds alone = latency + arbiter_->clocks().alone_ps(direction, bytes);
  wait(to_sc_time(latency));
  move(kProcessor, direction, bytes);
  processor_served_ = false;
  changed_.notify();
  // A retried read can end sooner than it would alone: what another master moves in the meantime
  // shifts its attempts to where the target is just ready.
  const Picoseconds waited = std::max<Picoseconds>(0, now_ps() - start - alone);
  if (waited > 0) ledger_.extend(tag, Part::bus, Phase::arbitration, start, start + waited);
  ledger_.extend(tag, Part::bus, phase, start + waited, now_ps());
}

void PciBus::move(int master, link::Direction direction, std::int64_t bytes) {
  arbiter_->request(master, direction, bytes, now_ps());
  changed_.notify();
  while (!arbiter_->done(master)) {
    wait(to_sc_time(arbiter_->forecast(master) - now_ps()), changed_);
    arbiter_->advance(now_ps());
  }
}

// Wait states of a target, with the bus.
void PciBus::hold(Picoseconds time) {
  if (arbiter_) {
    arbiter_->hold(now_ps() + time);
    changed_.notify();
  } else {
    free_at_ = now_ps() + time;
    busy_ += time;
  }
  wait(to_sc_time(time));
}

Picoseconds PciBus::busy() const {
  if (!arbiter_) return busy_;
  Picoseconds owned = arbiter_->held_ps();
  for (int master = 0; master < kMasters; ++master) owned += arbiter_->statistics(master).owned_ps;
  return owned;
}

}  // namespace hvp::vp
