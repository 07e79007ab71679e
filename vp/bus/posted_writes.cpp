#include "vp/bus/posted_writes.h"

#include <utility>

namespace hvp::vp {

PostedWrite& PostedWrites::push(std::uint64_t address, const std::uint8_t* data,
                                std::size_t bytes) {
  ++count_;
  PostedWrite& write = back();
  write.address = address;
  write.data = std::move(spare_.back());
  spare_.pop_back();
  write.data.assign(data, data + bytes);
  write.sender = nullptr;
  write.inside = static_cast<std::int64_t>(bytes);
  return write;
}

void PostedWrites::pop() {
  spare_.push_back(std::move(front().data));
  first_ = (first_ + 1) % places_.size();
  --count_;
}

std::int64_t PostedWrites::bytes_inside() const {
  std::int64_t bytes = 0;
  for (std::size_t i = 0; i < count_; ++i) bytes += places_[(first_ + i) % places_.size()].inside;
  return bytes;
}

PostedTransaction::PostedTransaction() {
  payload_.set_extension(&extension_);
  payload_.set_byte_enable_ptr(nullptr);
}

PostedTransaction::~PostedTransaction() { payload_.clear_extension(&extension_); }

tlm::tlm_generic_payload& PostedTransaction::of(PostedWrite& write) {
  extension_.tag = &write.tag;
  payload_.set_command(tlm::TLM_WRITE_COMMAND);
  payload_.set_address(write.address);
  payload_.set_data_ptr(write.data.data());
  payload_.set_data_length(static_cast<unsigned>(write.data.size()));
  payload_.set_streaming_width(static_cast<unsigned>(write.data.size()));
  payload_.set_dmi_allowed(false);
  payload_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  return payload_;
}

}  // namespace hvp::vp
