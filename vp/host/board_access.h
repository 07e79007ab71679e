#pragma once

#include <cstddef>
#include <cstdint>
#include <systemc>

#include <tlm_utils/simple_initiator_socket.h>

#include "driver/hvp_driver.h"
#include "vp/frame_tag.h"
#include "vp/host/dispatcher.h"
#include "vp/host/local_time.h"
#include "vp/ledger.h"

namespace hvp::vp {

// Where the boards are in the host's memory map.
inline constexpr std::uint64_t kSolverBase = 0x1000'0000;
inline constexpr std::uint64_t kDaqBase = 0x2000'0000;

// The processor's way to the bus: turns the driver's call-backs and the servo process' accesses
// to the DAQ board into transactions, each with the tag of the frame that is worked on. The
// driver never sees the tag. Call-backs run in the servo thread and throw nothing, so that no
// C frame is ever unwound.
class BoardAccess : public sc_core::sc_module, public InterruptIf {
 public:
  // `dispatcher`: what wakes the process that waits for an interrupt; null: it runs at once.
  BoardAccess(const sc_core::sc_module_name& name, Picoseconds interrupt_latency, Ledger& ledger,
              Dispatcher* dispatcher = nullptr);
  ~BoardAccess() override;

  tlm_utils::simple_initiator_socket<BoardAccess> to_bus;

  // The driver's view of the solver board; valid as long as this object.
  const hvp_bus& solver_bus() const { return solver_bus_; }

  // The frame that accesses are for and its newest span.
  Tag& tag() { return tag_; }

  // The servo process' own time.
  LocalTime& time() { return time_; }

  // Where the board has answered the frame that is worked on, the frame follows what the board did.
  void follow_interrupt();

  // Single accesses to any board; false where nobody answered.
  bool write(std::uint64_t address, const void* data, std::size_t bytes);
  bool read(std::uint64_t address, void* data, std::size_t bytes);

  // InterruptIf
  void interrupt(const Tag& tag) override;
  void lowered() override;

 private:
  bool transport(tlm::tlm_command command, std::uint64_t address, unsigned char* data,
                 std::size_t bytes);
  int wait_interrupt(std::uint64_t timeout_ns);

  Picoseconds interrupt_latency_;
  Ledger& ledger_;
  Dispatcher* dispatcher_;
  hvp_bus solver_bus_{};
  Tag tag_;
  LocalTime time_;
  tlm::tlm_generic_payload payload_;
  FrameTag extension_;
  bool line_up_ = false;
  Tag interrupt_tag_;
  sc_core::sc_event raised_;
};

}  // namespace hvp::vp
