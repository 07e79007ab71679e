#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hvp::vp::rtl {

// A signal that a waveform of engine.sv shows beside those that the translation has.
struct ShownSignal {
  std::string name;  // with its scopes, "SystemC.accelerator.engine.job"
  int bits = 1;      // 1, 32, 64 or kReal
  std::int64_t integer = 0;
  double real = 0;

  static constexpr int kReal = 0;
};
using ShownSignals = std::vector<ShownSignal>;

}  // namespace hvp::vp::rtl
