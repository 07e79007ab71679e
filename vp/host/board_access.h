#pragma once

#include <cstddef>
#include <cstdint>
#include <systemc>

#include <tlm_utils/simple_initiator_socket.h>

#include "driver/hvp_driver.h"
#include "vp/bus/host_memory.h"
#include "vp/bus/memory_map.h"
#include "vp/fault/bus_errors.h"
#include "vp/fpga/accelerator.h"
#include "vp/frame_tag.h"
#include "vp/host/dispatcher.h"
#include "vp/host/local_time.h"
#include "vp/host/transfer.h"
#include "vp/ledger.h"

namespace hvp::vp {

// The processor's way to the bus: turns the driver's call-backs and the servo process' accesses
// to the DAQ board into transactions, each with the tag of the frame that is worked on. The
// driver never sees the tag. Call-backs run in the servo thread and throw nothing, so that no
// C frame is ever unwound.
class BoardAccess : public sc_core::sc_module, public InterruptIf {
 public:
  // `dispatcher`: what wakes the process that waits for an interrupt; null: it runs at once.
  // `transfer`: what the driver's blocks become on the bus, and what it waits for.
  BoardAccess(const sc_core::sc_module_name& name, Picoseconds interrupt_latency, Ledger& ledger,
              Dispatcher* dispatcher = nullptr, const Transfer& transfer = {});
  ~BoardAccess() override;

  tlm_utils::simple_initiator_socket<BoardAccess> to_bus;

  // The driver's view of the solver board; valid as long as this object.
  const hvp_bus& solver_bus() const { return solver_bus_; }

  const Transfer& transfer() const { return transfer_; }

  // For a host that polls: when the board's last job had ended, so that a frame's critical path
  // goes through the board and not through the looks in vain.
  void watch(const JobEnd& job_end) { job_end_ = &job_end; }

  // From now on the driver can ask for what the bridge has recorded, at the cost of an access to
  // its configuration space, which does not go over the bus. Before the simulation starts.
  void report_errors(BusErrors& errors, Picoseconds read_time, Picoseconds clear_time);

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
  std::uint32_t take_errors();
  int wait_interrupt(std::uint64_t timeout_ns);
  bool messages() const { return transfer_.notification == link::Notification::msi; }
  bool by_words(tlm::tlm_command command) const;
  void transport_block(tlm::tlm_command command, std::uint32_t offset, std::uint32_t* words,
                       std::size_t count);
  std::uint32_t read_register(std::uint32_t offset);
  void poll_status(std::uint32_t& status);
  void pause();
  void note_looking(Picoseconds since, bool may_have_ended);

  Transfer transfer_;
  const JobEnd* job_end_ = nullptr;
  Picoseconds looking_since_ = 0;
  Picoseconds interrupt_latency_;
  Ledger& ledger_;
  Dispatcher* dispatcher_;
  hvp_bus solver_bus_{};
  Tag tag_;
  LocalTime time_;
  tlm::tlm_generic_payload payload_;
  FrameTag extension_;
  BusErrors* errors_ = nullptr;
  Picoseconds error_read_time_ = 0;
  Picoseconds error_clear_time_ = 0;
  bool line_up_ = false;
  Tag interrupt_tag_;
  sc_core::sc_event raised_;
};

}  // namespace hvp::vp
