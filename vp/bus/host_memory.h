#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <systemc>
#include <utility>
#include <vector>

#include <tlm_utils/simple_target_socket.h>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

// Where a message-signalled interrupt is written to: the first address of x86's window for messages
// to a processor's interrupt controller (Intel SDM volume 3, message address register: FEEh in bits
// 31 to 20).
inline constexpr std::uint64_t kMessageAddress = 0xFEE0'0000;
inline constexpr std::size_t kMessageBytes = 4;

// The host's memory as a board that is bus master sees it, and the window of messages behind it:
// an aligned write of four bytes to kMessageAddress is an interrupt, for the frame of the
// transaction's tag. It takes no time of its own; the bus in front of it does.
//
// Anything outside, a read of the window and a write of another size to it end in
// TLM_ADDRESS_ERROR_RESPONSE; a refused read gives all ones.
//
// A host of another program gives its own memory, in ranges by their bus addresses. What crosses
// from one range to the next is a transaction as any other.
class HostMemory : public sc_core::sc_module {
 public:
  // Bytes at the bus' addresses 0 to `bytes`, zero at first. Throws std::invalid_argument for a
  // memory that reaches into the window of messages.
  HostMemory(const sc_core::sc_module_name& name, std::size_t bytes);

  // Memory of somebody else's, at these addresses of the bus, until unmap(); only between
  // transactions. Throws std::invalid_argument where it overlaps what is there or the window of
  // messages, or is empty, or reaches beyond the last address.
  void map(std::uint64_t address, std::span<std::uint8_t> memory, bool writable = true);
  // All ranges that lie in [address, address + bytes); one that lies there in part is refused:
  // false, and nothing has changed.
  bool unmap(std::uint64_t address, std::uint64_t bytes);
  // Whether the board may be master, asked at every transaction; where not, nobody answers it.
  void answer_if(std::function<bool()> allowed) { allowed_ = std::move(allowed); }

  tlm_utils::simple_target_socket<HostMemory> from_bus;
  // Who takes the messages: an edge each, nobody lowers them. Unbound: they are lost.
  sc_core::sc_port<InterruptIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> interrupt;

  // What the processor sees at once.
  std::span<std::uint8_t> bytes() { return bytes_; }
  std::span<const std::uint8_t> bytes() const { return bytes_; }
  std::int64_t messages() const { return messages_; }

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  bool take_message(tlm::tlm_generic_payload& transaction);
  bool move(tlm::tlm_generic_payload& transaction);

  struct Range {
    std::uint64_t address;
    std::span<std::uint8_t> memory;
    bool writable;
  };
  // The one that has this address; null: none.
  const Range* range_at(std::uint64_t address) const;

  std::vector<std::uint8_t> bytes_;
  std::vector<Range> ranges_;  // by ascending address
  std::function<bool()> allowed_;
  std::int64_t messages_ = 0;
};

}  // namespace hvp::vp
