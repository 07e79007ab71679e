/* SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0 */
#ifndef HVP_CALLS_H
#define HVP_CALLS_H

#include "hvp_module.h"
#include "hvp_ioctl.h"

/**
 * union hvp_call - a program's structure, whichever call it is for
 * @head: the begin of each
 * @info: of %HVP_IOC_INFO
 * @config: of %HVP_IOC_CONFIGURE
 * @matrix: of %HVP_IOC_LOAD
 * @constraint: of %HVP_IOC_CONSTRAIN
 * @row: of %HVP_IOC_RESTORE
 * @values: of %HVP_IOC_UPDATE
 * @vector: of %HVP_IOC_WRITE_RHS, %HVP_IOC_WRITE_GUESS and %HVP_IOC_READ_SOLUTION
 * @wait: of %HVP_IOC_WAIT
 * @solve: of %HVP_IOC_SOLVE
 * @result: of %HVP_IOC_READ_RESULT
 * @statistics: of %HVP_IOC_STATISTICS
 */
union hvp_call {
	struct hvp_ioc_head head;
	struct hvp_ioc_info info;
	struct hvp_ioc_config config;
	struct hvp_ioc_matrix matrix;
	struct hvp_ioc_constraint constraint;
	struct hvp_ioc_row row;
	struct hvp_ioc_values values;
	struct hvp_ioc_vector vector;
	struct hvp_ioc_wait wait;
	struct hvp_ioc_solve solve;
	struct hvp_ioc_result result;
	struct hvp_ioc_statistics statistics;
};

/**
 * struct hvp_brought - what a call has brought into the kernel beside its structure
 * @elements: to be freed by kvfree(), or NULL
 */
struct hvp_brought {
	s32 *elements[3];
};

/*
 * A call has up to three parts. The first and the last touch the program's memory, which may take
 * any time, with the board's @calls held; they return 0 or an errno. In between it asks the core,
 * with @mutex held as well, and fills in its structure, what the core said in the head.
 */

/* hvp_matrix_calls.c */
int hvp_bring_matrix(struct hvp_board *board, const union hvp_call *call,
		     struct hvp_brought *brought);
int hvp_bring_row(struct hvp_board *board, const union hvp_call *call,
		  struct hvp_brought *brought);
int hvp_bring_values(struct hvp_board *board, const union hvp_call *call,
		     struct hvp_brought *brought);
void hvp_call_load(struct hvp_board *board, union hvp_call *call,
		   const struct hvp_brought *brought);
void hvp_call_update(struct hvp_board *board, union hvp_call *call,
		     const struct hvp_brought *brought);
void hvp_call_constrain(struct hvp_board *board, union hvp_call *call,
			const struct hvp_brought *brought);
void hvp_call_restore(struct hvp_board *board, union hvp_call *call,
		      const struct hvp_brought *brought);

/* hvp_job_calls.c */
u64 hvp_wait_limit(u64 timeout_ns);
int hvp_bring_vector(struct hvp_board *board, const union hvp_call *call,
		     struct hvp_brought *brought);
int hvp_bring_rhs(struct hvp_board *board, const union hvp_call *call,
		  struct hvp_brought *brought);
int hvp_bring_wait(struct hvp_board *board, const union hvp_call *call,
		   struct hvp_brought *brought);
int hvp_bring_place(struct hvp_board *board, const union hvp_call *call,
		    struct hvp_brought *brought);
void hvp_call_write_rhs(struct hvp_board *board, union hvp_call *call,
			const struct hvp_brought *brought);
void hvp_call_write_guess(struct hvp_board *board, union hvp_call *call,
			  const struct hvp_brought *brought);
void hvp_call_start(struct hvp_board *board, union hvp_call *call,
		    const struct hvp_brought *brought);
void hvp_call_wait(struct hvp_board *board, union hvp_call *call,
		   const struct hvp_brought *brought);
void hvp_call_read_solution(struct hvp_board *board, union hvp_call *call,
			    const struct hvp_brought *brought);
void hvp_call_read_result(struct hvp_board *board, union hvp_call *call,
			  const struct hvp_brought *brought);
void hvp_call_solve(struct hvp_board *board, union hvp_call *call,
		    const struct hvp_brought *brought);
int hvp_give_vector(struct hvp_board *board, const union hvp_call *call);
int hvp_give_solution(struct hvp_board *board, const union hvp_call *call);

/* hvp_calls.c */
bool hvp_call_exists(unsigned int command);
long hvp_call(struct hvp_board *board, unsigned int command, union hvp_call *call);

#endif
