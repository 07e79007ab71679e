#include "vp/bus/bus_transaction.h"

#include <cstring>
#include <utility>

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
