#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <systemc>
#include <utility>
#include <vector>

#include <tlm_utils/simple_target_socket.h>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

class WeakMemory;

// The boards' base addresses in the host's memory map.
inline constexpr std::uint64_t kSolverBase = 0x1000'0000;
inline constexpr std::uint64_t kDaqBase = 0x2000'0000;

// The address of message-signalled interrupts: the first address of x86's window for messages to a
// processor's interrupt controller (Intel SDM volume 3, message address register: FEEh in bits 31
// to 20).
inline constexpr std::uint64_t kMessageAddress = 0xFEE0'0000;
inline constexpr std::size_t kMessageBytes = 4;

// Sees what happens to the host's memory, each at its time. Messages are no access to it.
class MemoryObserver {
 public:
  virtual ~MemoryObserver() = default;
  virtual void mapped(std::uint64_t /*address*/, std::uint64_t /*bytes*/, bool /*writable*/) {}
  virtual void unmapped(std::uint64_t /*address*/, std::uint64_t /*bytes*/) {}
  // The board is about to read or write here; what it is to read may still be changed.
  virtual void to_be_moved(bool /*read*/, std::uint64_t /*address*/, std::size_t /*bytes*/) {}
  // The board has read or written `data`, or was refused.
  virtual void moved(bool /*read*/, std::uint64_t /*address*/,
                     std::span<const std::uint8_t> /*data*/, bool /*answered*/) {}
  // What the board reads or writes here, the host has stored without a barrier behind it.
  virtual void unordered(bool /*read*/, std::uint64_t /*address*/, std::size_t /*bytes*/) {}
  // A transaction was refused for a reason; `allowed` says that the board may be bus master.
  virtual void refused(const std::string& /*why*/, bool /*allowed*/) {}
};

// The host's memory as a board that is bus master sees it, and the window of messages behind it: an
// aligned write of four bytes to kMessageAddress is an interrupt, for the frame of the
// transaction's tag. It takes no time of its own; the bus in front of it does.
//
// An access outside, a read of the window and a write of another size to it end in
// TLM_ADDRESS_ERROR_RESPONSE; a refused read gives all ones. A warning says what was refused, in
// which job, and which memory lies nearest, or why the board may not reach it.
//
// A host of another program gives its own memory, in ranges by their bus addresses. A transaction
// may cross from one range to the next.
class HostMemory : public sc_core::sc_module {
 public:
  // Creates memory at the bus addresses 0 to `bytes`, zero at first. Throws std::invalid_argument
  // for a memory that reaches into the window of messages.
  HostMemory(const sc_core::sc_module_name& name, std::size_t bytes);

  // Maps memory of the caller's at this bus address, until unmap(); only between transactions.
  // Throws std::invalid_argument if it is empty, overlaps other memory or the window of messages,
  // or reaches beyond the last address.
  void map(std::uint64_t address, std::span<std::uint8_t> memory, bool writable = true);
  // Removes all ranges in [address, address + bytes). Returns false and changes nothing if one lies
  // there only in part.
  bool unmap(std::uint64_t address, std::uint64_t bytes);
  // `allowed` is called at every transaction and says whether the board may be bus master; if not,
  // no target answers.
  void answer_if(std::function<bool()> allowed) { allowed_ = std::move(allowed); }
  // Copies what is mapped at this address, at no time. Returns false and changes nothing if not all
  // of it is mapped.
  bool copy(std::uint64_t address, std::span<std::uint8_t> data) const;
  // As with an IOMMU in front of the memory: `why` is called at every transaction that is no
  // message, and says in words why the board may not make it; no words: it may.
  using WhyNot = std::function<std::string(std::uint64_t address, std::size_t bytes, bool write)>;
  void refuse_if(WhyNot why) { why_not_ = std::move(why); }
  // Shows the board the host's stores as `order` has them, from now on; null: at once. It hears of
  // no mapping by itself.
  void order_by(WeakMemory* order) { order_ = order; }
  // Reports to `observer` too from now on. Keeps a reference.
  void observe(MemoryObserver& observer) { observers_.push_back(&observer); }

  tlm_utils::simple_target_socket<HostMemory> from_bus;
  // The receiver of the messages. Each is an edge, which is not lowered. Unbound, messages are
  // lost.
  sc_core::sc_port<InterruptIf, 1, sc_core::SC_ZERO_OR_MORE_BOUND> interrupt;

  // The memory's contents, as the processor sees them.
  std::span<std::uint8_t> bytes() { return bytes_; }
  std::span<const std::uint8_t> bytes() const { return bytes_; }
  std::int64_t messages() const { return messages_; }

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  bool take_message(tlm::tlm_generic_payload& transaction);
  bool answer(tlm::tlm_generic_payload& transaction, bool allowed);
  bool move(tlm::tlm_generic_payload& transaction);
  // True if all of it is mapped, and writable where it has to be. The next two expect that.
  bool holds(std::uint64_t first, std::size_t length, bool write) const;
  void get(std::uint64_t first, std::span<std::uint8_t> data) const;
  void put(std::uint64_t first, std::span<const std::uint8_t> data);
  template <class Visit>
  bool each_part(std::uint64_t first, std::size_t length, bool write, const Visit& visit) const;
  std::string refusal(tlm::tlm_generic_payload& transaction, const std::string& why) const;

  struct Range {
    std::uint64_t address;
    std::span<std::uint8_t> memory;
    bool writable;
  };
  // The range with this address; null: none.
  const Range* range_at(std::uint64_t address) const;

  std::vector<std::uint8_t> bytes_;
  std::vector<Range> ranges_;  // by ascending address
  std::function<bool()> allowed_;
  std::vector<MemoryObserver*> observers_;
  WhyNot why_not_;
  WeakMemory* order_ = nullptr;
  std::vector<std::uint8_t> ordered_;  // what memory gets in place of what is written
  std::int64_t messages_ = 0;
};

}  // namespace hvp::vp
