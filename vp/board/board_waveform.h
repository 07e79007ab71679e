#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <systemc>

#include "vp/fpga/accelerator.h"

namespace hvp::vp {

// A VCD file (IEEE 1364, for GTKWave and Surfer) of what happens between software and the board:
// the registers that change by themselves, the interrupt line, and every access with its offset and
// first word; and of a board that is a bus master each transaction of its own, from its begin to
// its end. It has no process: SystemC's tracer samples the values after a change.
class BoardWaveform : public AccessObserver, private MasterObserver {
 public:
  // Writes `path` with the suffix ".vcd".
  explicit BoardWaveform(const std::string& path);
  // Once, before simulation starts. The accelerator has to outlive close().
  void watch(Accelerator& accelerator);
  // Completes the file.
  void close() { file_.reset(); }

  void access(Picoseconds time, Command command, const RegisterBank& bank,
              const AccessResult& outcome, std::uint64_t offset,
              std::span<const std::uint8_t> data) override;

 private:
  void begins(const MasterAccess& access) override;
  void transferred(const MasterAccess& /*access*/) override { moves_ = false; }

  struct Close {
    void operator()(sc_core::sc_trace_file* file) const { sc_core::sc_close_vcd_trace_file(file); }
  };

  std::unique_ptr<sc_core::sc_trace_file, Close> file_;
  // The toggle separates two equal accesses.
  bool toggle_ = false;
  bool write_ = false;
  bool refused_ = false;
  std::uint32_t offset_ = 0;
  std::uint32_t bytes_ = 0;
  std::uint32_t word_ = 0;
  // The board's own transaction. The toggle separates two that follow each other at once.
  bool moves_ = false;
  bool move_toggle_ = false;
  bool move_reads_ = false;
  std::uint32_t move_purpose_ = 0;  // MasterPurpose
  std::uint64_t move_address_ = 0;
  std::uint32_t move_bytes_ = 0;
};

}  // namespace hvp::vp
