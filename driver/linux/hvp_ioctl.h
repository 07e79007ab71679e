/* SPDX-License-Identifier: Apache-2.0 */
/*
 * The device file of a solver board, /dev/hvpN: what a program and the kernel
 * module say to each other. The calls are those of driver/hvp_driver.h, which
 * says what each does and when it may be called; driver/user/hvp_client.h is
 * the library that makes them.
 *
 * Every ioctl takes one of these structures. Its first member is a struct
 * hvp_ioc_head, which the kernel fills whether the call succeeds or not: the
 * hvp_status of driver/hvp_status.h, and what goes with it. The ioctl returns 0
 * where that is HVP_OK, and fails with the errno of driver/hvp_errno.h
 * elsewhere. It fails without having filled anything, which a program sees by
 * the HVP_IOC_UNTOUCHED that it wrote there, where the structure itself could
 * not be read or written (EFAULT), a pad or an unknown flag is not zero
 * (EINVAL), or there is no such call (ENOTTY).
 *
 * An address in the program's memory is a __u64. All structures have the same
 * layout for 32- and 64-bit programs. Pads are zero.
 *
 * A file is opened by one program at a time (EBUSY). Its last close aborts what
 * runs and resets the board. Calls through one file are serialised.
 *
 * poll(): EPOLLIN once the job that was started last has ended, or was lost in
 * a suspend or a reset of the function, until HVP_IOC_WAIT has taken it;
 * EPOLLHUP when the board is gone. An early EPOLLIN is possible: HVP_IOC_WAIT
 * with a timeout of 0 then says HVP_ERROR_TIMEOUT and takes it away.
 *
 * mmap(): the memory that the board's DMA engine moves b from and U to, where
 * HVP_IOC_F_DMA is set: at offset HVP_IOC_MAP_RHS with PROT_READ | PROT_WRITE,
 * rhs_bytes long, and at HVP_IOC_MAP_SOLUTION with PROT_READ, solution_bytes
 * long. Elements are as they travel: little-endian, two in a 32-bit word where
 * they have at most 16 bits and one_a_word is not set, the first in the lower
 * half. A program that writes b there leaves HVP_IOC_WRITE_RHS out, and nobody
 * checks its words; one that reads U there leaves HVP_IOC_READ_SOLUTION out.
 * Not while a job runs.
 */
#ifndef HVP_IOCTL_H
#define HVP_IOCTL_H

#include <linux/ioctl.h>
#include <linux/types.h>

/* Grows when a program has to change; a program compares it. */
#define HVP_IOC_ABI 1

/* In hvp_ioc_head.status before the call: no hvp_status. */
#define HVP_IOC_UNTOUCHED 0xffffffffU

struct hvp_ioc_head {
	__u32 status;		/* out: hvp_status */
	__u32 detail;		/* out: hvp_error_detail() */
};

#define HVP_IOC_F_DMA		0x01 /* b, U and values go by the board's DMA engine */
#define HVP_IOC_F_MSI		0x02 /* interrupts are messages */
#define HVP_IOC_F_POLLED	0x04 /* there are no interrupts */

#define HVP_IOC_MAP_RHS		0x00000000U
#define HVP_IOC_MAP_SOLUTION	0x10000000U

/* What the board and the module are: needs no board that answers. */
struct hvp_ioc_info {
	struct hvp_ioc_head head;
	__u32 abi;		/* HVP_IOC_ABI */
	__u32 flags;		/* HVP_IOC_F_... */
	__u32 max_nodes;	/* from here: struct hvp_capability */
	__u32 max_row_blocks;
	__u32 max_blocks;
	__u32 max_matrix_bits;
	__u32 max_vector_bits;
	__u32 max_rhs_bits;
	__u32 max_coefficient_bits;
	__u32 clock_khz;
	__u32 methods;
	__u32 start_modes;
	__u32 max_scalar_bits;
	__u32 max_timeout_ms;	/* the longest wait; a longer one is cut */
	__u32 rhs_bytes;	/* of the mapped memory; 0 without DMA */
	__u32 solution_bytes;
};

#define HVP_IOC_C_DYNAMIC_SCALING	0x01
#define HVP_IOC_C_SCALING_UP_ONLY	0x02
#define HVP_IOC_C_FIXED_COEFFICIENTS	0x04
#define HVP_IOC_C_ONE_A_WORD		0x08
#define HVP_IOC_C_WRAP_OVERFLOW		0x10
#define HVP_IOC_C_REJECT_SATURATED	0x20
#define HVP_IOC_C_ALL			0x3f

/* struct hvp_solver_config, its bools as HVP_IOC_C_... */
struct hvp_ioc_config {
	struct hvp_ioc_head head;
	__u64 stop_residual;
	__u32 flags;
	__u32 method;
	__u32 start;
	__u32 iterations;
	__u32 replace_every;
	__u32 static_shift;
	__u32 headroom_bits;
	__u32 scaling_threshold;
	__u32 scaling_step;
	__u32 matrix_bits;
	__u32 vector_bits;
	__u32 rhs_bits;
	__u32 scalar_bits;
	__u32 coefficient_bits;
	__u32 alpha_fraction;
	__u32 beta_fraction;
	__u32 division_rounding;
	__u32 shift_rounding;
};

/* struct hvp_matrix. EINTR: call again with the same matrix. */
struct hvp_ioc_matrix {
	struct hvp_ioc_head head;
	__u32 nodes;
	__u32 blocks;
	__u64 row_begin;	/* const __s32[nodes + 1] */
	__u64 column;		/* const __s32[blocks] */
	__u64 value;		/* const __s32[9 * blocks] */
};

struct hvp_ioc_constraint {
	struct hvp_ioc_head head;
	__u32 node;
	__s32 diagonal;
};

struct hvp_ioc_row {
	struct hvp_ioc_head head;
	__u32 node;
	__u32 blocks;
	__u64 values;		/* const __s32[9 * blocks] */
};

/*
 * All entries of the loaded matrix anew, its pattern stays; n is 9 * blocks.
 * EINTR: call again with the same values.
 */
struct hvp_ioc_values {
	struct hvp_ioc_head head;
	__u64 values;		/* const __s32[n] */
	__u64 timeout_ns;	/* of the wait after the last was sent */
	__u32 n;
	__u32 pad;
};

/* b, a guess or U; n is 3 * nodes. */
struct hvp_ioc_vector {
	struct hvp_ioc_head head;
	__u64 elements;		/* __s32[n] */
	__u32 n;
	__u32 pad;
};

/* EINTR: the job goes on; wait again. */
struct hvp_ioc_wait {
	struct hvp_ioc_head head;
	__u64 timeout_ns;
	__u32 flags;		/* out: hvp_last_flags() */
	__u32 pad;
};

/*
 * b, a start, a wait and U. EINTR: the job goes on; HVP_IOC_WAIT, then
 * HVP_IOC_READ_SOLUTION.
 */
struct hvp_ioc_solve {
	struct hvp_ioc_head head;
	__u64 rhs;		/* const __s32[n] */
	__u64 solution;		/* __s32[n] */
	__u64 timeout_ns;
	__u32 n;
	__u32 flags;		/* out: hvp_last_flags() */
};

/* struct hvp_result */
struct hvp_ioc_result {
	struct hvp_ioc_head head;
	__u64 cycles;
	__u32 job;
	__u32 iterations;
	__u32 reached;		/* 0 or 1 */
	__u32 replacements;
	__u32 saturations;
	__u32 wraps;
	__u32 breakdowns;
	__u32 flags;
};

/* Since the module has found the board. */
struct hvp_ioc_statistics {
	struct hvp_ioc_head head;
	__u64 jobs;		/* started */
	__u32 lost_interrupts;	/* from here: struct hvp_statistics */
	__u32 lost_acknowledgements;
};

/* 0xE7 is free in Documentation/userspace-api/ioctl/ioctl-number.rst. */
#define HVP_IOC_MAGIC 0xE7

#define HVP_IOC_INFO		_IOWR(HVP_IOC_MAGIC, 0x00, struct hvp_ioc_info)
#define HVP_IOC_RESET		_IOWR(HVP_IOC_MAGIC, 0x01, struct hvp_ioc_head)
#define HVP_IOC_CONFIGURE	_IOWR(HVP_IOC_MAGIC, 0x02, struct hvp_ioc_config)
#define HVP_IOC_LOAD		_IOWR(HVP_IOC_MAGIC, 0x03, struct hvp_ioc_matrix)
#define HVP_IOC_CONSTRAIN	_IOWR(HVP_IOC_MAGIC, 0x04, struct hvp_ioc_constraint)
#define HVP_IOC_RESTORE		_IOWR(HVP_IOC_MAGIC, 0x05, struct hvp_ioc_row)
#define HVP_IOC_WRITE_RHS	_IOWR(HVP_IOC_MAGIC, 0x06, struct hvp_ioc_vector)
#define HVP_IOC_WRITE_GUESS	_IOWR(HVP_IOC_MAGIC, 0x07, struct hvp_ioc_vector)
#define HVP_IOC_START		_IOWR(HVP_IOC_MAGIC, 0x08, struct hvp_ioc_head)
#define HVP_IOC_WAIT		_IOWR(HVP_IOC_MAGIC, 0x09, struct hvp_ioc_wait)
#define HVP_IOC_READ_SOLUTION	_IOWR(HVP_IOC_MAGIC, 0x0a, struct hvp_ioc_vector)
#define HVP_IOC_READ_RESULT	_IOWR(HVP_IOC_MAGIC, 0x0b, struct hvp_ioc_result)
#define HVP_IOC_SOLVE		_IOWR(HVP_IOC_MAGIC, 0x0c, struct hvp_ioc_solve)
#define HVP_IOC_STATISTICS	_IOWR(HVP_IOC_MAGIC, 0x0d, struct hvp_ioc_statistics)
#define HVP_IOC_UPDATE		_IOWR(HVP_IOC_MAGIC, 0x0e, struct hvp_ioc_values)

#endif
