#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <systemc>

#include "vp/fpga/accelerator.h"

namespace hvp::vp {

// What software and the board do to each other as a VCD file (IEEE 1364) that GTKWave and Surfer
// show: the registers that change by themselves, the interrupt line, and every access with its
// offset and first word. Without a process: SystemC's tracer looks at them when something happens.
class BoardWaveform : public AccessObserver {
 public:
  // Writes `path` with the suffix ".vcd".
  explicit BoardWaveform(const std::string& path);
  // Once, before simulation starts. The accelerator has to outlive close().
  void watch(const Accelerator& accelerator);
  // The file is whole.
  void close() { file_.reset(); }

  void access(Picoseconds time, Command command, const RegisterBank& bank,
              const AccessResult& outcome, std::uint64_t offset,
              std::span<const std::uint8_t> data) override;

 private:
  struct Close {
    void operator()(sc_core::sc_trace_file* file) const { sc_core::sc_close_vcd_trace_file(file); }
  };

  std::unique_ptr<sc_core::sc_trace_file, Close> file_;
  // Two accesses of the same kind are told apart by the toggle.
  bool toggle_ = false;
  bool write_ = false;
  bool refused_ = false;
  std::uint32_t offset_ = 0;
  std::uint32_t bytes_ = 0;
  std::uint32_t word_ = 0;
};

}  // namespace hvp::vp
