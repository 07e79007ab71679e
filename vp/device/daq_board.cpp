#include "vp/device/daq_board.h"

#include <cstring>

namespace hvp::vp {

DaqBoard::DaqBoard(const sc_core::sc_module_name& name, const plant::DeviceSettings& settings,
                   plant::Device& device, const Session& session, Ledger& ledger, Picoseconds delay)
    : sc_module(name),
      from_bus("from_bus"),
      encoder_(settings.encoder),
      device_(device),
      session_(session),
      ledger_(ledger),
      sampling_(to_picoseconds(settings.daq.sampling_delay)),
      output_(to_picoseconds(settings.daq.output_delay)),
      delay_(delay) {
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
  } else if (transaction.is_read() && address == kPosition && bytes == sizeof(latched_)) {
    std::memcpy(transaction.get_data_ptr(), latched_.data(), sizeof(latched_));
  } else if (transaction.is_write() && address == kForce && bytes == 12) {
    put_out(transaction.get_data_ptr(), tag);
  } else {
    transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
}

void DaqBoard::latch(Tag& tag) {
  const Picoseconds start = now_ps();
  Eigen::Vector3d position = device_.at(start - session_.begin).position;
  if (encoder_) position = encoder_->read(position);
  for (int i = 0; i < 3; ++i) {
    latched_[static_cast<std::size_t>(i)] = plant::kPosition.to_counts(position[i]).value;
  }
  wait(to_sc_time(sampling_));
  ledger_.extend(tag, Part::daq, Phase::sample, start, now_ps());
}

// The converter works on while the host does; nobody waits for it, so that no event is due.
void DaqBoard::put_out(const unsigned char* words, const Tag& tag) {
  std::array<std::int32_t, 3> counts{};
  std::memcpy(counts.data(), words, sizeof(counts));
  Eigen::Vector3d force;
  for (int i = 0; i < 3; ++i) {
    force[i] = plant::kForce.to_value(counts[static_cast<std::size_t>(i)]);
  }
  const Picoseconds start = now_ps();
  const Picoseconds settled = start + output_;
  const Picoseconds there = settled + delay_;
  device_.drive(there - session_.begin, force);
  Tag output = tag;
  ledger_.extend(output, Part::daq, Phase::convert, start, settled);
  if (delay_ > 0) ledger_.extend(output, Part::host, Phase::delay, settled, there);
  ledger_.extend(output, Part::device, Phase::motor, there, there);
  ledger_.force_at_motor(output);
}

}  // namespace hvp::vp
