#include "vp/device/daq_board.h"

#include <cmath>
#include <cstring>

namespace hvp::vp {

DaqBoard::DaqBoard(const sc_core::sc_module_name& name, const plant::Daq& model,
                   const std::optional<plant::Encoder>& encoder,
                   const plant::Trajectory& trajectory, const Session& session, Ledger& ledger)
    : sc_module(name),
      from_bus("from_bus"),
      encoder_(encoder),
      trajectory_(trajectory),
      session_(session),
      ledger_(ledger),
      sampling_(std::llround(model.sampling_delay * 1e12)),
      output_(std::llround(model.output_delay * 1e12)) {
  from_bus.register_b_transport(this, &DaqBoard::b_transport);
}

void DaqBoard::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& /*delay*/) {
  Tag none;
  Tag& tag = tag_of(transaction, none);
  const std::uint64_t address = transaction.get_address();
  const unsigned bytes = transaction.get_data_length();
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);

  if (transaction.is_write() && address == kLatch && bytes == 4) {
    Eigen::Vector3d position = trajectory_.state_ps(now_ps() - session_.begin).position;
    if (encoder_) position = encoder_->read(position);
    for (int i = 0; i < 3; ++i) {
      latched_[static_cast<std::size_t>(i)] = plant::kPosition.to_counts(position[i]).value;
    }
    const Picoseconds start = now_ps();
    wait(to_sc_time(sampling_));
    ledger_.extend(tag, Part::daq, Phase::sample, start, now_ps());
  } else if (transaction.is_read() && address == kPosition && bytes == sizeof(latched_)) {
    std::memcpy(transaction.get_data_ptr(), latched_.data(), sizeof(latched_));
  } else if (transaction.is_write() && address == kForce && bytes == 12) {
    // The converter works on while the host does; nobody waits for it, so that no event is due.
    Tag output = tag;
    const Picoseconds start = now_ps();
    ledger_.extend(output, Part::daq, Phase::convert, start, start + output_);
    ledger_.extend(output, Part::device, Phase::motor, start + output_, start + output_);
    if (tag.frame >= 0) ledger_.frame(tag.frame).force_at_motor = output.cause;
  } else {
    transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
}

}  // namespace hvp::vp
