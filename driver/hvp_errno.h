// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
#ifndef HVP_ERRNO_H
#define HVP_ERRNO_H

#include "driver/hvp_status.h"

#ifdef __KERNEL__
#include <linux/errno.h>
#else
#include <errno.h>
#endif

// A status as one of Linux's error numbers, positive; 0 for HVP_OK. It says less than the status,
// which the device file gives beside it (driver/linux/hvp_ioctl.h). An interrupted wait is EINTR
// here; a kernel returns hvp_caller_error() instead.
static inline int hvp_errno_of(hvp_status status) {
  switch (status) {
    case HVP_OK:
      return 0;
    case HVP_ERROR_ARGUMENT:
    case HVP_ERROR_BAD_SIZE:
    case HVP_ERROR_BAD_MATRIX:
    case HVP_ERROR_BAD_SETTING:
    case HVP_ERROR_BAD_NODE:
    case HVP_ERROR_BAD_ROW:
      return EINVAL;
    case HVP_ERROR_STATE:
    case HVP_ERROR_NOT_LOADED:
      return EBADFD;
    case HVP_ERROR_RANGE:
      return ERANGE;
    case HVP_ERROR_CAPABILITY:
      return EOPNOTSUPP;
    case HVP_ERROR_NO_DEVICE:
      return ENODEV;
    case HVP_ERROR_VERSION:
      return EPROTONOSUPPORT;
    case HVP_ERROR_TIMEOUT:
      return ETIMEDOUT;
    case HVP_ERROR_INTERRUPTED:
      return EINTR;
    case HVP_ERROR_DATA:
      return EBADMSG;
    case HVP_ERROR_STALE_RESULT:
      return ESTALE;
    case HVP_ERROR_SATURATED:
      return EOVERFLOW;
    case HVP_ERROR_BUS:
    case HVP_ERROR_SHORT_TRANSFER:
    case HVP_ERROR_BAD_DESCRIPTOR:
    case HVP_ERROR_DMA:
    case HVP_ERROR_ILLEGAL_ACCESS:
    case HVP_ERROR_BOARD:
    case HVP_STATUS_COUNT:
      break;
  }
  return EIO;
}

#endif
