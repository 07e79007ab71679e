#include "vp/bus/host_memory.h"

#include <cstring>
#include <stdexcept>

namespace hvp::vp {

namespace {

bool plain(const tlm::tlm_generic_payload& transaction) {
  return transaction.get_byte_enable_ptr() == nullptr && transaction.get_data_length() > 0 &&
         transaction.get_streaming_width() >= transaction.get_data_length();
}

std::size_t outside_the_window(std::size_t bytes) {
  if (bytes > kMessageAddress) {
    throw std::invalid_argument("the host's memory reaches into the window of messages");
  }
  return bytes;
}

}  // namespace

HostMemory::HostMemory(const sc_core::sc_module_name& name, std::size_t bytes)
    : sc_module(name),
      from_bus("from_bus"),
      interrupt("interrupt"),
      bytes_(outside_the_window(bytes)) {
  from_bus.register_b_transport(this, &HostMemory::b_transport);
}

void HostMemory::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& /*delay*/) {
  const std::uint64_t address = transaction.get_address();
  const std::size_t length = transaction.get_data_length();
  unsigned char* const data = transaction.get_data_ptr();
  if (!plain(transaction)) {
    transaction.set_response_status(tlm::TLM_BURST_ERROR_RESPONSE);
  } else if (take_message(transaction)) {
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
  } else if (address > bytes_.size() || length > bytes_.size() - address) {
    transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  } else {
    if (transaction.is_write()) {
      std::memcpy(bytes_.data() + address, data, length);
    } else if (transaction.is_read()) {
      std::memcpy(data, bytes_.data() + address, length);
    }
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
    return;
  }
  if (transaction.is_read() && data != nullptr) std::memset(data, 0xff, length);
}

bool HostMemory::take_message(tlm::tlm_generic_payload& transaction) {
  if (!transaction.is_write() || transaction.get_address() != kMessageAddress ||
      transaction.get_data_length() != kMessageBytes) {
    return false;
  }
  ++messages_;
  Tag none;
  if (interrupt.size() > 0) interrupt->interrupt(tag_of(transaction, none));
  return true;
}

}  // namespace hvp::vp
