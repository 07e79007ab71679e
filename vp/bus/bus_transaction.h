#pragma once

#include <cstddef>
#include <cstdint>
#include <tlm>
#include <vector>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

inline std::int64_t bytes_of(const tlm::tlm_generic_payload& transaction) {
  return static_cast<std::int64_t>(transaction.get_data_length());
}

// The phase of a processor's transaction in the ledger. A block is more than a word of four bytes.
Phase processors_phase(const tlm::tlm_generic_payload& transaction);
// The phase of a board's transaction, unless the transaction states one. A write to kMessageAddress
// is an interrupt.
Phase boards_phase(tlm::tlm_generic_payload& transaction);

// Ends a transaction to an address that no target claims: an address error and, for a read, all
// ones (PCI 3.0 §3.3.3.1; likewise for an unsupported request at a PCIe root port).
void master_abort(tlm::tlm_generic_payload& transaction);

// The stack of a process that delivers posted writes: the work that a write starts, even a board's
// solve, runs on it.
inline constexpr std::size_t kTargetsStackBytes = 1 << 20;

// A write whose sender has gone on. Its tag is the sender's before the write, so that its spans are
// a branch of the frame of their own.
struct PostedWrite {
  std::uint64_t address = 0;
  std::vector<std::uint8_t> data;  // empty: a message without data
  Tag tag;
  Phase phase = Phase::bus_write;
  Picoseconds began = 0;    // when the sender began
  Picoseconds due = 0;      // its meaning is the user's
  std::int64_t inside = 0;  // bytes that still need their place in the buffer
  // The tag of a sender that waits until its write has left, which then follows the write's spans;
  // else null.
  Tag* sender = nullptr;
};

// A queue of posted writes. The data storage that was freed last is used first and keeps its size,
// so that a frame loop does not allocate.
class PostedWrites {
 public:
  explicit PostedWrites(std::size_t places) : places_(places), spare_(places) {}

  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == places_.size(); }
  std::size_t count() const { return count_; }
  // The queue must not be empty for these, nor full for push().
  PostedWrite& front() { return places_[first_]; }
  PostedWrite& at(std::size_t place) { return places_[(first_ + place) % places_.size()]; }
  PostedWrite& back() { return at(count_ - 1); }
  PostedWrite& push(std::uint64_t address, const std::uint8_t* data, std::size_t bytes);
  void pop();
  // The sum over all writes.
  std::int64_t bytes_inside() const;

 private:
  std::vector<PostedWrite> places_;
  std::vector<std::vector<std::uint8_t>> spare_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

// The transaction that carries posted writes to their target, one at a time.
class PostedTransaction {
 public:
  PostedTransaction();
  ~PostedTransaction();
  PostedTransaction(const PostedTransaction&) = delete;
  PostedTransaction& operator=(const PostedTransaction&) = delete;

  // The transaction for `write`, with the write's own tag. It is valid until the next call.
  tlm::tlm_generic_payload& of(PostedWrite& write);

 private:
  tlm::tlm_generic_payload payload_;
  FrameTag extension_;
};

}  // namespace hvp::vp
