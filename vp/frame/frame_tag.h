#pragma once

#include <optional>
#include <tlm>

#include "vp/frame/frame.h"

namespace hvp::vp {

// Rides on every transaction and says for which frame it is. The initiator owns the tag; every
// part that the transaction passes adds its spans to it.
struct FrameTag : tlm::tlm_extension<FrameTag> {
  Tag* tag = nullptr;
  // What the bus is to call a board's own transaction, where its kind does not say it: that a read
  // fetches a descriptor.
  std::optional<Phase> phase;
  // Whose work it is where the tag is of no frame, so that it leaves no span: a look in vain.
  std::optional<std::int64_t> unseen_frame;

  tlm::tlm_extension_base* clone() const override {
    auto* copy = new FrameTag;
    copy->tag = tag;
    copy->phase = phase;
    copy->unseen_frame = unseen_frame;
    return copy;
  }
  void copy_from(const tlm::tlm_extension_base& other) override {
    const auto& from = static_cast<const FrameTag&>(other);
    tag = from.tag;
    phase = from.phase;
    unseen_frame = from.unseen_frame;
  }
};

// The tag of a transaction, or one for no frame where it carries none.
inline Tag& tag_of(tlm::tlm_generic_payload& transaction, Tag& none) {
  FrameTag* extension = nullptr;
  transaction.get_extension(extension);
  return extension != nullptr && extension->tag != nullptr ? *extension->tag : none;
}

// The frame whose work a transaction is, with spans or without; −1: none.
inline std::int64_t frame_of(tlm::tlm_generic_payload& transaction) {
  FrameTag* extension = nullptr;
  transaction.get_extension(extension);
  if (extension == nullptr) return -1;
  if (extension->unseen_frame) return *extension->unseen_frame;
  return extension->tag != nullptr ? extension->tag->frame : -1;
}

// The phase of a board's own transaction, where it is named.
inline std::optional<Phase> phase_of(tlm::tlm_generic_payload& transaction) {
  FrameTag* extension = nullptr;
  transaction.get_extension(extension);
  return extension != nullptr ? extension->phase : std::nullopt;
}

// A request line that says which frame's work raised it: the board's INTA#.
class InterruptIf : public virtual sc_core::sc_interface {
 public:
  // The line went up; once, until it went down again.
  virtual void interrupt(const Tag& tag) = 0;
  virtual void lowered() = 0;
};

inline Picoseconds now_ps() { return static_cast<Picoseconds>(sc_core::sc_time_stamp().value()); }

inline sc_core::sc_time to_sc_time(Picoseconds ps) {
  return sc_core::sc_time::from_value(static_cast<sc_dt::uint64>(ps));
}

// Returns at once where the time has come already.
inline void wait_until(Picoseconds time) {
  if (time > now_ps()) sc_core::wait(to_sc_time(time - now_ps()));
}

}  // namespace hvp::vp
