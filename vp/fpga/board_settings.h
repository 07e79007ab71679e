#pragma once

#include "models/fixed/settings.h"
#include "vp/fpga/board_matrix.h"
#include "vp/fpga/register_bank.h"

namespace hvp::vp {

// Says in CAPABILITY_FORMAT how long the words of the modelled board may be.
void strap_capability(RegisterBank& bank);

// The settings that METHOD to START_MODE hold. What concerns only the host (units, the scaling of
// the matrix) stays at its default. Returns bad_setting with the offset of the register that the
// board cannot work with; `settings` is valid only without an error.
BoardError read_settings(const RegisterBank& bank, fixed::Settings& settings);

}  // namespace hvp::vp
