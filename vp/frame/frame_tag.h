#pragma once

#include <optional>
#include <tlm>

#include "vp/frame/frame.h"

namespace hvp::vp {

// The extension that tells a transaction's frame. The initiator owns the tag, and every part that
// the transaction passes adds its spans to it.
struct FrameTag : tlm::tlm_extension<FrameTag> {
  Tag* tag = nullptr;
  // The phase of the board's own transaction, if its kind does not tell it: a read may fetch a
  // descriptor.
  std::optional<Phase> phase;
  // The frame of a transaction that leaves no span, because its tag has no frame: a poll that found
  // the job not done.
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

// The tag of a transaction, or `none` if it carries no tag.
inline Tag& tag_of(tlm::tlm_generic_payload& transaction, Tag& none) {
  FrameTag* extension = nullptr;
  transaction.get_extension(extension);
  return extension != nullptr && extension->tag != nullptr ? *extension->tag : none;
}

// The frame of a transaction, whether it leaves spans or not; −1: none.
inline std::int64_t frame_of(tlm::tlm_generic_payload& transaction) {
  FrameTag* extension = nullptr;
  transaction.get_extension(extension);
  if (extension == nullptr) return -1;
  if (extension->unseen_frame) return *extension->unseen_frame;
  return extension->tag != nullptr ? extension->tag->frame : -1;
}

// The phase that a board's own transaction states.
inline std::optional<Phase> phase_of(tlm::tlm_generic_payload& transaction) {
  FrameTag* extension = nullptr;
  transaction.get_extension(extension);
  return extension != nullptr ? extension->phase : std::nullopt;
}

// An interrupt request line, the board's INTA#, that tells the frame it was raised for.
class InterruptIf : public virtual sc_core::sc_interface {
 public:
  // The line went up. Called once until it goes down again.
  virtual void interrupt(const Tag& tag) = 0;
  virtual void lowered() = 0;
};

inline Picoseconds now_ps() { return static_cast<Picoseconds>(sc_core::sc_time_stamp().value()); }

inline sc_core::sc_time to_sc_time(Picoseconds ps) {
  return sc_core::sc_time::from_value(static_cast<sc_dt::uint64>(ps));
}

// Returns at once if the time has passed.
inline void wait_until(Picoseconds time) {
  if (time > now_ps()) sc_core::wait(to_sc_time(time - now_ps()));
}

}  // namespace hvp::vp
