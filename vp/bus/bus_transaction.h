#pragma once

#include <cstdint>
#include <tlm>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

inline std::int64_t bytes_of(const tlm::tlm_generic_payload& transaction) {
  return static_cast<std::int64_t>(transaction.get_data_length());
}

// What a bus calls a transaction in the ledger: a block is more than a word of four bytes.
Phase processors_phase(const tlm::tlm_generic_payload& transaction);
// A board's, unless it says itself what it is for: a write to kMessageAddress is an interrupt.
Phase boards_phase(tlm::tlm_generic_payload& transaction);

// What a processor or a board sees of an address that nobody claims: an address error and, for a
// read, all ones (PCI 3.0 §3.3.3.1; of a PCIe root port's unsupported request likewise).
void master_abort(tlm::tlm_generic_payload& transaction);

}  // namespace hvp::vp
