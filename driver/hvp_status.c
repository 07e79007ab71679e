// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#include "driver/hvp_status.h"

#include "driver/hvp_transfer.h"

const char* hvp_status_text(hvp_status status) {
  switch (status) {
    case HVP_OK:
      return "success";
    case HVP_ERROR_ARGUMENT:
      return "an argument is wrong: a null pointer, a wrong count or an impossible setting";
    case HVP_ERROR_STATE:
      return "not allowed now: the board is not open, not configured, not loaded or still busy";
    case HVP_ERROR_RANGE:
      return "a value does not fit the configured word length";
    case HVP_ERROR_CAPABILITY:
      return "the board cannot do this much: compare with its capability registers";
    case HVP_ERROR_NO_DEVICE:
      return "no solver board answers at this address";
    case HVP_ERROR_VERSION:
      return "the board has a register map that this driver does not know";
    case HVP_ERROR_BUS:
      return "the bus failed or the board stopped answering";
    case HVP_ERROR_TIMEOUT:
      return "the board is still busy: wait again or reset it";
    case HVP_ERROR_INTERRUPTED:
      return "the wait was interrupted and the board goes on: call again";
    case HVP_ERROR_DATA:
      return "a word was damaged on the bus";
    case HVP_ERROR_STALE_RESULT:
      return "the results on the board, or its completion record, belong to another job";
    case HVP_ERROR_SHORT_TRANSFER:
      return "the board's DMA engine moved another number of bytes than it was asked to";
    case HVP_ERROR_SATURATED:
      return "the solve reached the limits of its words";
    case HVP_ERROR_BAD_SIZE:
      return "the matrix is empty or larger than the board";
    case HVP_ERROR_BAD_MATRIX:
      return "the pattern of the matrix is wrong: rows, ascending columns or a diagonal block";
    case HVP_ERROR_BAD_SETTING:
      return "the board does not support a setting";
    case HVP_ERROR_NOT_LOADED:
      return "the board has no matrix";
    case HVP_ERROR_BAD_NODE:
      return "the matrix has no such node";
    case HVP_ERROR_BAD_ROW:
      return "the row given back has another number of blocks than the board's";
    case HVP_ERROR_BAD_DESCRIPTOR:
      return "the board's DMA engine refused a descriptor";
    case HVP_ERROR_DMA:
      return "the host's memory did not answer the board's DMA engine";
    case HVP_ERROR_ILLEGAL_ACCESS:
      return "an access that the register map does not allow was refused";
    case HVP_ERROR_BOARD:
      return "the board stopped on a fault of its own";
    case HVP_STATUS_COUNT:
      break;
  }
  return "not a status of this driver";
}

const char* hvp_status_name(hvp_status status) {
  static const char* const names[HVP_STATUS_COUNT] = {
      "HVP_OK",
      "HVP_ERROR_ARGUMENT",
      "HVP_ERROR_STATE",
      "HVP_ERROR_RANGE",
      "HVP_ERROR_CAPABILITY",
      "HVP_ERROR_NO_DEVICE",
      "HVP_ERROR_VERSION",
      "HVP_ERROR_BUS",
      "HVP_ERROR_TIMEOUT",
      "HVP_ERROR_INTERRUPTED",
      "HVP_ERROR_DATA",
      "HVP_ERROR_STALE_RESULT",
      "HVP_ERROR_SHORT_TRANSFER",
      "HVP_ERROR_SATURATED",
      "HVP_ERROR_BAD_SIZE",
      "HVP_ERROR_BAD_MATRIX",
      "HVP_ERROR_BAD_SETTING",
      "HVP_ERROR_NOT_LOADED",
      "HVP_ERROR_BAD_NODE",
      "HVP_ERROR_BAD_ROW",
      "HVP_ERROR_BAD_DESCRIPTOR",
      "HVP_ERROR_DMA",
      "HVP_ERROR_ILLEGAL_ACCESS",
      "HVP_ERROR_BOARD",
  };
  return (unsigned)status < HVP_STATUS_COUNT ? names[status] : "HVP_STATUS_UNKNOWN";
}

hvp_status hvp_status_of_board(unsigned error_code) {
  switch (error_code) {
    case HVP_ERROR_CODE_BAD_SIZE:
      return HVP_ERROR_BAD_SIZE;
    case HVP_ERROR_CODE_BAD_MATRIX:
      return HVP_ERROR_BAD_MATRIX;
    case HVP_ERROR_CODE_BAD_SETTING:
      return HVP_ERROR_BAD_SETTING;
    case HVP_ERROR_CODE_NOT_LOADED:
      return HVP_ERROR_NOT_LOADED;
    case HVP_ERROR_CODE_BAD_NODE:
      return HVP_ERROR_BAD_NODE;
    case HVP_ERROR_CODE_BAD_ROW:
      return HVP_ERROR_BAD_ROW;
    case HVP_ERROR_CODE_BAD_DESCRIPTOR:
      return HVP_ERROR_BAD_DESCRIPTOR;
    case HVP_ERROR_CODE_DMA_FAILED:
      return HVP_ERROR_DMA;
    case HVP_ERROR_CODE_ILLEGAL_ACCESS:
      return HVP_ERROR_ILLEGAL_ACCESS;
    default:
      return HVP_ERROR_BOARD;
  }
}

hvp_status hvp_status_of_bus(unsigned errors) {
  if ((errors & HVP_BUS_MASTER_ABORT) != 0U) return HVP_ERROR_BUS;
  return errors == 0U ? HVP_OK : HVP_ERROR_DATA;
}
