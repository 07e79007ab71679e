#include "vp/host/board_access.h"

namespace hvp::vp {

BoardAccess::BoardAccess(const sc_core::sc_module_name& name, bool messages)
    : sc_module(name), to_bus("to_bus"), messages_(messages), interrupted_("raised") {
  extension_.tag = &tag_;
  payload_.set_extension(&extension_);
  payload_.set_byte_enable_ptr(nullptr);
}

BoardAccess::~BoardAccess() { payload_.clear_extension(&extension_); }

bool BoardAccess::write(std::uint64_t address, const void* data, std::size_t bytes) {
  // A payload's data pointer is not const, though a write only reads it.
  return transport(tlm::TLM_WRITE_COMMAND, address,
                   const_cast<unsigned char*>(static_cast<const unsigned char*>(data)), bytes);
}

bool BoardAccess::read(std::uint64_t address, void* data, std::size_t bytes) {
  return transport(tlm::TLM_READ_COMMAND, address, static_cast<unsigned char*>(data), bytes);
}

bool BoardAccess::look(std::uint64_t address, void* data, std::size_t bytes) {
  Tag nothing;
  extension_.tag = &nothing;
  extension_.unseen_frame = tag_.frame;
  const bool answered = read(address, data, bytes);
  extension_.tag = &tag_;
  extension_.unseen_frame.reset();
  return answered;
}

bool BoardAccess::transport(tlm::tlm_command command, std::uint64_t address, unsigned char* data,
                            std::size_t bytes) {
  payload_.set_command(command);
  payload_.set_address(address);
  payload_.set_data_ptr(data);
  payload_.set_data_length(static_cast<unsigned>(bytes));
  payload_.set_streaming_width(static_cast<unsigned>(bytes));
  payload_.set_dmi_allowed(false);
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  sc_core::sc_time delay = time_.ahead();
  to_bus->b_transport(payload_, delay);
  wait(delay);
  time_.restart();
  return payload_.is_response_ok();
}

void BoardAccess::interrupt(const Tag& tag) {
  if (!has_interrupt_ || messages_) interrupt_tag_ = tag;
  has_interrupt_ = true;
  interrupted_.notify(sc_core::SC_ZERO_TIME);
}

void BoardAccess::follow_interrupt() {
  if (has_interrupt_ && interrupt_tag_.frame == tag_.frame) tag_.cause = interrupt_tag_.cause;
}

}  // namespace hvp::vp
