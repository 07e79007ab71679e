#pragma once

#include <functional>

#include "models/accel/critical_path.h"

namespace hvp::accel {

// Every kind of path between two registers of the configured engine: the SpMxV sub-blocks as
// vp/fpga/rtl/spmxv.sv has them, the vector unit, the divider, host access, and the limits of the
// blocks. A path holds only until the next one. The device has to have delays.
void each_path(const Clocking& c, const std::function<void(const Path&)>& take);

}  // namespace hvp::accel
