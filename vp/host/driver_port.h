#pragma once

#include <cstddef>
#include <cstdint>
#include <systemc>

#include "driver/hvp_driver.h"
#include "vp/fault/fault_plan.h"
#include "vp/fpga/accelerator.h"
#include "vp/frame/ledger.h"
#include "vp/host/board_access.h"
#include "vp/host/dispatcher.h"
#include "vp/host/transfer.h"

namespace hvp::vp {

// The port of the solver board's driver: its call-backs as accesses of the processor and as waits
// of the calling process. The driver does not know which frame it works for. Call-backs run in the
// calling process and throw nothing, so that no C frame is ever unwound.
class DriverPort {
 public:
  // Keeps references. `dispatcher` wakes the process that waits for an interrupt; null: it runs at
  // once. `transfer` decides how the driver's blocks go over the bus and how the driver waits.
  DriverPort(BoardAccess& access, Picoseconds interrupt_latency, Ledger& ledger,
             Dispatcher* dispatcher = nullptr, const Transfer& transfer = {});
  DriverPort(const DriverPort&) = delete;
  DriverPort& operator=(const DriverPort&) = delete;

  // The argument of hvp_open(). It is valid as long as this object.
  const hvp_bus& bus() const { return bus_; }
  const Transfer& transfer() const { return transfer_; }

  // Gives a polling host the end of the board's last job, so that a frame's critical path goes
  // through the board and not through polls that found it busy.
  void watch(const JobEnd& job_end) { job_end_ = &job_end; }
  // Lets the driver read the errors that the bridge has recorded, at the cost of an access to the
  // bridge's configuration space, which does not go over the bus. To be called before the
  // simulation starts.
  void report_errors(BusErrors& errors, Picoseconds read_time, Picoseconds clear_time);

 private:
  bool by_words(tlm::tlm_command command) const;
  void transport_block(tlm::tlm_command command, std::uint32_t offset, std::uint32_t* words,
                       std::size_t count);
  std::uint32_t read_register(std::uint32_t offset);
  std::uint32_t take_errors();
  int wait_interrupt(std::uint64_t timeout_ns);
  void pause();
  void note_looking(Picoseconds since, bool may_have_ended);

  BoardAccess& access_;
  Tag& tag_;
  LocalTime& time_;
  Picoseconds interrupt_latency_;
  Ledger& ledger_;
  Dispatcher* dispatcher_;
  Transfer transfer_;
  hvp_bus bus_{};
  const JobEnd* job_end_ = nullptr;
  Picoseconds looking_since_ = 0;
  BusErrors* errors_ = nullptr;
  Picoseconds error_read_time_ = 0;
  Picoseconds error_clear_time_ = 0;
};

}  // namespace hvp::vp
