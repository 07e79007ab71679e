#include "vp/board/faulty_wire.h"

#include <algorithm>
#include <cstring>

#include "vp/fpga/register_bank.h"

namespace hvp::vp {

namespace {

bool within(std::uint64_t offset, Aperture aperture) {
  const ApertureInfo& row = kApertures[static_cast<std::size_t>(aperture)];
  return offset >= row.offset && offset - row.offset < row.size;
}

std::uint32_t word_of(const tlm::tlm_generic_payload& transaction) {
  std::uint32_t word = 0;
  std::memcpy(&word, transaction.get_data_ptr(),
              std::min<std::size_t>(sizeof(word), transaction.get_data_length()));
  return word;
}

// The kind of the driver's access, by its address.
FaultAccess access_of(const tlm::tlm_generic_payload& transaction) {
  const std::uint64_t offset = transaction.get_address();
  const bool read = transaction.is_read();
  if (!read && within(offset, Aperture::value)) return FaultAccess::values;
  if (!read && within(offset, Aperture::b)) return FaultAccess::rhs;
  if (read && within(offset, Aperture::u)) return FaultAccess::solution;
  if (!read && offset == offset_of(Register::control) &&
      (word_of(transaction) & (field::kControlStart.mask() | field::kControlRunList.mask())) != 0) {
    return FaultAccess::start;
  }
  if (read && offset == offset_of(Register::status)) return FaultAccess::status;
  if (!read && offset == offset_of(Register::interrupt_status)) return FaultAccess::acknowledge;
  return FaultAccess::first;
}

}  // namespace

void FaultyWire::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  Tag none;
  const FaultAccess access = access_of(transaction);
  const std::int64_t frame = tag_of(transaction, none).frame;
  const bool gone = plan_.gone(now_ps(), frame);
  if (plan_.take_return()) reset_board();
  if (!gone && plan_.strike(FaultKind::surprise_removal, frame, access) != nullptr) {
    plan_.remove();
    abort(transaction);
    return;
  }
  if (gone || plan_.strike(FaultKind::master_abort, frame, access) != nullptr) {
    abort(transaction);
    return;
  }
  if (link_ != nullptr && transaction.is_write() &&
      plan_.strike(FaultKind::aer_uncorrectable, frame, access) != nullptr) {
    poison(transaction);
    return;
  }
  const Fault* const bad =
      link_ == nullptr ? nullptr : plan_.strike(FaultKind::aer_correctable, frame, access);
  if (bad != nullptr) {
    plan_.tell_of_packet_error(bad->kind);
    replay(transaction, *bad, request_wire_bytes(transaction), delay);
    return;
  }
  // The words of b, U and the matrix go one by one with programmed I/O.
  const bool block = transaction.get_data_length() > 4 || access == FaultAccess::rhs ||
                     access == FaultAccess::solution || access == FaultAccess::values;
  const Fault* corrupted = block ? plan_.strike(FaultKind::corrupted_word, frame, access) : nullptr;
  if (corrupted == nullptr) {
    to_board_(transaction, delay);
  } else if (link_ != nullptr) {
    replay(transaction, *corrupted, data_wire_bytes(transaction), delay);
  } else {
    corrupt(transaction, *corrupted, frame, delay);
  }
}

// The receiver's Nak takes the packet's way back, and the packet comes again (PCIe 5.0 §3.6.2).
void FaultyWire::replay(tlm::tlm_generic_payload& transaction, const Fault& fault,
                        std::int64_t wire_bytes, sc_core::sc_time& delay) {
  to_board_(transaction, delay);
  delay += to_sc_time(2 * link_->link_ps() + link_->transfer_ps(wire_bytes));
  plan_.correct(fault);
}

// The packet with the first words, whichever way they go.
std::int64_t FaultyWire::data_wire_bytes(const tlm::tlm_generic_payload& transaction) const {
  return link_->write_wire_bytes(
      std::min<std::int64_t>(transaction.get_data_length(), link_->max_payload_bytes));
}

// The packet on its way to the board: that of a read has no words.
std::int64_t FaultyWire::request_wire_bytes(const tlm::tlm_generic_payload& transaction) const {
  if (transaction.is_write()) return data_wire_bytes(transaction);
  return link_->request_wire_bytes(
      std::min<std::int64_t>(transaction.get_data_length(), link_->max_read_request_bytes));
}

// PCI 3.0 §3.3.3.1: the master ends the access that nobody has claimed; its bridge remembers.
void FaultyWire::abort(tlm::tlm_generic_payload& transaction) {
  if (link_ == nullptr || transaction.is_read()) errors_.master_abort = true;
  if (transaction.is_read()) {
    std::memset(transaction.get_data_ptr(), 0xff, transaction.get_data_length());
  }
  transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

// PCIe 5.0 §2.7.2: who receives it drops it and sets the bit for parity in its status. (The
// requests of reads have no data to be poisoned; of a poisoned answer the root port would tell.)
void FaultyWire::poison(tlm::tlm_generic_payload& transaction) {
  errors_.parity = true;
  plan_.tell_of_packet_error(FaultKind::aer_uncorrectable);
  transaction.set_response_status(tlm::TLM_OK_RESPONSE);
}

void FaultyWire::corrupt(tlm::tlm_generic_payload& transaction, const Fault& fault,
                         std::int64_t frame, sc_core::sc_time& delay) {
  const std::uint32_t mask = plan_.mask(fault, frame);
  unsigned char* damaged = transaction.get_data_ptr() +
                           4ULL * plan_.word(fault, frame, transaction.get_data_length() / 4);
  const auto flip = [damaged, mask] {
    std::uint32_t word = 0;
    std::memcpy(&word, damaged, sizeof(word));
    word ^= mask;
    std::memcpy(damaged, &word, sizeof(word));
  };
  // The memory of whoever writes stays as it is.
  const bool write = transaction.is_write();
  if (write) flip();
  to_board_(transaction, delay);
  flip();
  if (fault.flipped_bits() % 2 != 0) errors_.parity = true;
}

// Returns the board to its state after power-on, without settings and matrix.
void FaultyWire::reset_board() {
  Tag none;
  FrameTag extension;
  extension.tag = &none;
  std::uint32_t command = field::kControlReset.mask();
  tlm::tlm_generic_payload payload;
  payload.set_extension(&extension);
  payload.set_write();
  payload.set_address(offset_of(Register::control));
  payload.set_data_ptr(reinterpret_cast<unsigned char*>(&command));
  payload.set_data_length(sizeof(command));
  payload.set_streaming_width(sizeof(command));
  payload.set_byte_enable_ptr(nullptr);
  payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  sc_core::sc_time none_taken = sc_core::SC_ZERO_TIME;
  to_board_(payload, none_taken);
  payload.clear_extension(&extension);
}

}  // namespace hvp::vp
