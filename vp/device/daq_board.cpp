#include "vp/device/daq_board.h"

#include <array>
#include <cstring>
#include <utility>

namespace hvp::vp {

DaqBoard::DaqBoard(const sc_core::sc_module_name& name, const plant::DeviceSettings& settings,
                   std::vector<plant::Device*> devices, const Session& session, Ledger& ledger,
                   Picoseconds delay)
    : sc_module(name),
      from_bus("from_bus"),
      encoder_(settings.encoder),
      devices_(std::move(devices)),
      session_(session),
      ledger_(ledger),
      sampling_(to_picoseconds(settings.daq.sampling_delay)),
      output_(to_picoseconds(settings.daq.output_delay)),
      delay_(delay),
      latched_(3 * devices_.size()) {
  from_bus.register_b_transport(this, &DaqBoard::b_transport);
}

void DaqBoard::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& /*delay*/) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const std::uint64_t address = transaction.get_address();
  const unsigned bytes = transaction.get_data_length();
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);

  if (transaction.is_write() && address == kLatch && bytes == 4) {
    latch(tag);
  } else if (transaction.is_read() && address == kPosition && bytes == 4 * latched_.size()) {
    std::memcpy(transaction.get_data_ptr(), latched_.data(), bytes);
  } else if (transaction.is_write() && address == kForce && bytes == 4 * latched_.size()) {
    put_out(transaction.get_data_ptr(), tag);
  } else {
    transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
}

void DaqBoard::latch(Tag& tag) {
  const Picoseconds start = now_ps();
  std::size_t next = 0;
  for (plant::Device* device : devices_) {
    Eigen::Vector3d position = device->at(start - session_.begin).position;
    if (encoder_) position = encoder_->read(position);
    for (int i = 0; i < 3; ++i) latched_[next++] = plant::kPosition.to_counts(position[i]).value;
  }
  wait(to_sc_time(sampling_));
  ledger_.extend(tag, Part::daq, Phase::sample, start, now_ps());
}

// The converter works on while the host does; nobody waits for it, so that no event is due.
void DaqBoard::put_out(const unsigned char* words, const Tag& tag) {
  const Picoseconds start = now_ps();
  const Picoseconds settled = start + output_;
  const Picoseconds there = settled + delay_;
  for (plant::Device* device : devices_) {
    std::array<std::int32_t, 3> counts{};
    std::memcpy(counts.data(), words, sizeof(counts));
    words += sizeof(counts);
    const Eigen::Vector3d force(plant::kForce.to_value(counts[0]),
                                plant::kForce.to_value(counts[1]),
                                plant::kForce.to_value(counts[2]));
    device->drive(there - session_.begin, force);
  }
  Tag output = tag;
  ledger_.extend(output, Part::daq, Phase::convert, start, settled);
  if (delay_ > 0) ledger_.extend(output, Part::host, Phase::delay, settled, there);
  ledger_.extend(output, Part::device, Phase::motor, there, there);
  ledger_.force_at_motor(output);
}

}  // namespace hvp::vp
