// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_STATUS_H
#define HVP_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

// The result of every function of the driver; hvp_status_text() says it in words. The errors from
// HVP_ERROR_BAD_SIZE on are the board's; the driver also returns them for its own checks
// beforehand. A kernel hands the numbers to programs (driver/linux/hvp_ioctl.h), so that they must
// not change, and a new one goes to the end.
typedef enum hvp_status {
  HVP_OK = 0,
  HVP_ERROR_ARGUMENT,      // a null pointer, a wrong count, a setting that no board has
  HVP_ERROR_STATE,         // not now: see the order of calls in docs/driver.md
  HVP_ERROR_RANGE,         // a value does not fit the configured word length; nothing was written
  HVP_ERROR_CAPABILITY,    // more than this board can do
  HVP_ERROR_NO_DEVICE,     // no solver board answers at this address
  HVP_ERROR_VERSION,       // a register map this driver does not know
  HVP_ERROR_BUS,           // the bus reported a failure, or the board stopped answering
  HVP_ERROR_TIMEOUT,       // the board is still busy: wait again, or hvp_reset()
  HVP_ERROR_INTERRUPTED,   // the wait was interrupted, the board goes on: call again
  HVP_ERROR_DATA,          // a word was damaged on the bus: what was sent or read is not to be used
  HVP_ERROR_STALE_RESULT,  // the results on the board, or the completion record, are another job's
  HVP_ERROR_SHORT_TRANSFER,  // the engine moved another number of bytes than it was asked to
  HVP_ERROR_SATURATED,       // the solve reached the limits of its words, and was not to
  HVP_ERROR_BAD_SIZE,
  HVP_ERROR_BAD_MATRIX,
  HVP_ERROR_BAD_SETTING,
  HVP_ERROR_NOT_LOADED,
  HVP_ERROR_BAD_NODE,
  HVP_ERROR_BAD_ROW,
  HVP_ERROR_BAD_DESCRIPTOR,
  HVP_ERROR_DMA,             // the host's memory did not answer the board
  HVP_ERROR_ILLEGAL_ACCESS,  // someone made an access that the register map does not allow
  HVP_ERROR_BOARD,           // a fault of the board's own, or a code this driver does not know
  HVP_STATUS_COUNT
} hvp_status;

const char* hvp_status_text(hvp_status status);
// The name in the code: "HVP_ERROR_TIMEOUT".
const char* hvp_status_name(hvp_status status);
// What a code of the board's register ERROR is to the driver's caller.
hvp_status hvp_status_of_board(unsigned error_code);
// What the errors that struct hvp_bus' take_errors returns are.
hvp_status hvp_status_of_bus(unsigned errors);

#ifdef __cplusplus
}
#endif

#endif
