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

  while (free_at_ > now_ps()) {
    const Picoseconds asked = now_ps();
    wait(to_sc_time(free_at_ - asked));
    ledger_.extend(tag, Part::bus, Phase::arbitration, asked, now_ps());
  }
  const bool read = transaction.is_read();
  const auto bytes = static_cast<std::int64_t>(transaction.get_data_length());
  const bool block = bytes > 4;
  const Picoseconds start = now_ps();
  const Picoseconds time = untimed_ ? 0 : read ? model_.read_ps(bytes) : model_.write_ps(bytes);
  free_at_ = start + time;
  wait(to_sc_time(time));
  ledger_.extend(tag, Part::bus,
                 read ? (block ? Phase::block_read : Phase::bus_read)
                      : (block ? Phase::block_write : Phase::bus_write),
                 start, now_ps());
  ++transactions_;
  bytes_ += bytes;
  busy_ += time;

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
  if (held > 0) {
    free_at_ = now_ps() + held;
    busy_ += held;
    wait(delay);
  }
  delay = sc_core::SC_ZERO_TIME;
}

}  // namespace hvp::vp
