#pragma once

#include <cstddef>
#include <cstdint>
#include <systemc>

#include <tlm_utils/simple_initiator_socket.h>

#include "vp/bus/memory_map.h"
#include "vp/frame/frame_tag.h"
#include "vp/host/local_time.h"

namespace hvp::vp {

// The processor's way to the bus, and where the solver board's interrupts arrive: each access is a
// transaction with the tag of the frame that is worked on, in the caller's process.
class BoardAccess : public sc_core::sc_module, public InterruptIf {
 public:
  // `messages`: interrupts are edges, each taken by the wait that it ends; else a line, which stays
  // up until the board lowers it.
  explicit BoardAccess(const sc_core::sc_module_name& name, bool messages = false);
  ~BoardAccess() override;

  tlm_utils::simple_initiator_socket<BoardAccess> to_bus;

  // The frame that accesses are for and its newest span.
  Tag& tag() { return tag_; }
  // The servo process' own time.
  LocalTime& time() { return time_; }

  // Single accesses to any board; false where nobody answered.
  bool write(std::uint64_t address, const void* data, std::size_t bytes);
  bool read(std::uint64_t address, void* data, std::size_t bytes);
  // As read(), of the tag's frame and without a span.
  bool look(std::uint64_t address, void* data, std::size_t bytes);

  bool has_interrupt() const { return has_interrupt_; }
  // Whose work the last one was raised for.
  const Tag& interrupt_tag() const { return interrupt_tag_; }
  const sc_core::sc_event& interrupted() const { return interrupted_; }
  // A wait has ended with it.
  void take_interrupt() { has_interrupt_ = has_interrupt_ && !messages_; }
  // Where the board has answered the frame that is worked on, the frame follows what the board did.
  void follow_interrupt();

  // InterruptIf
  void interrupt(const Tag& tag) override;
  void lowered() override { has_interrupt_ = false; }

 private:
  bool transport(tlm::tlm_command command, std::uint64_t address, unsigned char* data,
                 std::size_t bytes);

  bool messages_;
  Tag tag_;
  LocalTime time_;
  tlm::tlm_generic_payload payload_;
  FrameTag extension_;
  bool has_interrupt_ = false;
  Tag interrupt_tag_;
  sc_core::sc_event interrupted_;
};

}  // namespace hvp::vp
