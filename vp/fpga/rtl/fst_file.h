#pragma once

#include <cstdint>
#include <string>
#include <vector>

// Verilator's headers take SystemC's clock for theirs and expect its name here.
#include <systemc>
using sc_core::sc_time_stamp;

#include <verilated_fst_c.h>

#include "vp/fpga/rtl/shown_signals.h"

namespace hvp::vp::rtl {

// A waveform in GTKWave's format FST: all signals of a translated model, in its own scopes, and
// those of `shown`, which has to stay in place.
class FstFile {
 public:
  // `model` has tracing compiled in. Throws std::runtime_error where the file cannot be written.
  template <class Model>
  FstFile(const std::string& path, Model& model, const ShownSignals& shown) : shown_(shown) {
    model.trace(&fst_, kAllLevels);
    open(path);
  }

  // Writes what has changed; times have to grow.
  void dump(std::int64_t time_ps) { fst_.dump(static_cast<std::uint64_t>(time_ps)); }
  void close() { fst_.close(); }

 private:
  static constexpr int kAllLevels = 99;
  using Buffer = VerilatedFst::Buffer;

  void open(const std::string& path);
  static void declare(void* self, VerilatedFst* trace, std::uint32_t code);
  template <auto kReal, auto kBit, auto kQuad, auto kBus>
  void write(Buffer* buffer) const;
  static void write_all(void* self, Buffer* buffer);
  static void write_changes(void* self, Buffer* buffer);

  const ShownSignals& shown_;
  std::vector<std::uint32_t> code_;
  VerilatedFstC fst_;
};

}  // namespace hvp::vp::rtl
