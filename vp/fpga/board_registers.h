#pragma once

#include <cstdint>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "vp/fpga/register_bank.h"

namespace hvp::vp {

// An error as the registers ERROR and ERROR_DETAIL contain it.
struct BoardError {
  ErrorCode code = ErrorCode::none;
  std::uint32_t detail = 0;
  std::uint32_t place = 0;  // ERROR.place
};

// What says that the board does not take a field's value.
BoardError bad_setting(Field field);

// Checks the contents of ROW_BEGIN, COLUMN and VALUE, as load_done does, and makes the matrix of
// them. `matrix` is valid only without an error. The values have no unit on the board: the scale is
// one.
BoardError read_matrix(const RegisterBank& bank, fixed::QuantisedMatrix& matrix);

// Reads VALUE, as update_values does, into the matrix whose pattern is loaded. Blocks in the rows
// and columns of contact nodes keep their words. The matrix changes only without an error. Does not
// allocate.
BoardError read_values(const RegisterBank& bank, fixed::QuantisedMatrix& matrix);

// Copies the block row and the block column of a node into VALUE, after an update.
void write_back_node(const fixed::QuantisedMatrix& matrix, int node, RegisterBank& bank);

// The settings in the registers METHOD to START_MODE. The host's own settings (units, the scaling
// of the matrix) stay at their defaults. Returns bad_setting() of the first field whose value
// the board does not support; `settings` is valid only without an error.
BoardError read_settings(const RegisterBank& bank, fixed::Settings& settings);

}  // namespace hvp::vp
