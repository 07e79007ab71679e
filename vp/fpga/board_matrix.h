#pragma once

#include <cstdint>

#include "models/fixed/quantised_matrix.h"
#include "vp/fpga/register_bank.h"

namespace hvp::vp {

// An error as the registers ERROR and ERROR_DETAIL hold it.
struct BoardError {
  ErrorCode code = ErrorCode::none;
  std::uint32_t detail = 0;
};

// Checks what the host wrote into ROW_BEGIN, COLUMN and VALUE, as load_done does, and makes the
// matrix out of it. `matrix` is valid only without an error. The values have no unit on the
// board: its scale is one.
BoardError read_matrix(const RegisterBank& bank, fixed::QuantisedMatrix& matrix);

// Copies the block row and the block column of a node into VALUE, after an update.
void write_back_node(const fixed::QuantisedMatrix& matrix, int node, RegisterBank& bank);

}  // namespace hvp::vp
