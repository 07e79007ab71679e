#include "vp/bus/bus_transaction.h"

#include <cstring>

#include "vp/bus/host_memory.h"

namespace hvp::vp {

Phase processors_phase(const tlm::tlm_generic_payload& transaction) {
  const bool block = transaction.get_data_length() > 4;
  if (transaction.is_read()) return block ? Phase::block_read : Phase::bus_read;
  return block ? Phase::block_write : Phase::bus_write;
}

Phase boards_phase(tlm::tlm_generic_payload& transaction) {
  if (const std::optional<Phase> named = phase_of(transaction)) return *named;
  if (transaction.is_read()) return Phase::dma_read;
  return transaction.get_address() == kMessageAddress ? Phase::message : Phase::dma_write;
}

void master_abort(tlm::tlm_generic_payload& transaction) {
  transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  if (!transaction.is_read()) return;
  std::memset(transaction.get_data_ptr(), 0xff, transaction.get_data_length());
}

}  // namespace hvp::vp
