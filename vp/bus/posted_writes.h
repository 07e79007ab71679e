#pragma once

#include <cstddef>
#include <cstdint>
#include <tlm>
#include <vector>

#include "vp/frame/frame_tag.h"

namespace hvp::vp {

// Of a process that delivers posted writes: what a write starts, a board's solve too, runs on it.
inline constexpr std::size_t kTargetsStackBytes = 1 << 20;

// A write whose sender has gone on. Its tag is the sender's from before the write, so that its
// spans are a branch of their own of the frame.
struct PostedWrite {
  std::uint64_t address = 0;
  std::vector<std::uint8_t> data;  // empty: a message without data
  Tag tag;
  Phase phase = Phase::bus_write;
  Picoseconds began = 0;    // when the sender began
  Picoseconds due = 0;      // what it means is its user's
  std::int64_t inside = 0;  // bytes that still need their place in the buffer
  // Of a sender that waits until its write has left: its tag then follows what that took.
  Tag* sender = nullptr;
};

// Posted writes in their order. Storage for data that was given back last is used first and keeps
// its size, so that a frame loop does not allocate.
class PostedWrites {
 public:
  explicit PostedWrites(std::size_t places) : places_(places), spare_(places) {}

  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == places_.size(); }
  std::size_t count() const { return count_; }
  // Not of an empty or full ring.
  PostedWrite& front() { return places_[first_]; }
  PostedWrite& at(std::size_t place) { return places_[(first_ + place) % places_.size()]; }
  PostedWrite& back() { return at(count_ - 1); }
  PostedWrite& push(std::uint64_t address, const std::uint8_t* data, std::size_t bytes);
  void pop();
  // Of all of them.
  std::int64_t bytes_inside() const;

 private:
  std::vector<PostedWrite> places_;
  std::vector<std::vector<std::uint8_t>> spare_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

// The transaction that carries a posted write to its target; one at a time.
class PostedTransaction {
 public:
  PostedTransaction();
  ~PostedTransaction();
  PostedTransaction(const PostedTransaction&) = delete;
  PostedTransaction& operator=(const PostedTransaction&) = delete;

  // With the write's own tag; valid until the next call.
  tlm::tlm_generic_payload& of(PostedWrite& write);

 private:
  tlm::tlm_generic_payload payload_;
  FrameTag extension_;
};

}  // namespace hvp::vp
