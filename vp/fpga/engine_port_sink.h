#pragma once

#include <cstdint>
#include <functional>

namespace hvp::vp {

// Told what the host does to the port of the engine in SystemVerilog, and what comes back: a letter
// and three numbers, as vp/fpga/rtl/engine_testbench.sv reads them.
using EnginePortSink = std::function<void(char, std::uint32_t, std::uint32_t, std::uint32_t)>;

}  // namespace hvp::vp
