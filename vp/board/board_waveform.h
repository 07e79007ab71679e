#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <systemc>

#include "vp/fpga/accelerator.h"

namespace hvp::vp {

// A VCD file (IEEE 1364, for GTKWave and Surfer) of what happens between software and the board:
// the registers that change by themselves, the interrupt line, and every access with its offset and
// first word. It has no process: SystemC's tracer samples the values after a change.
class BoardWaveform : public AccessObserver {
 public:
  // Writes `path` with the suffix ".vcd".
  explicit BoardWaveform(const std::string& path);
  // Once, before simulation starts. The accelerator has to outlive close().
  void watch(const Accelerator& accelerator);
  // Completes the file.
  void close() { file_.reset(); }

  void access(Picoseconds time, Command command, const RegisterBank& bank,
              const AccessResult& outcome, std::uint64_t offset,
              std::span<const std::uint8_t> data) override;

 private:
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
};

}  // namespace hvp::vp
