// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The calls of the device file that make a job: vectors, the start, the wait, what came of it.
 */
#include <linux/uaccess.h>

#include "driver/hvp_device.h"

#include "hvp_calls.h"

static u64 wait_limit(u64 timeout_ns)
{
	return min_t(u64, timeout_ns, (u64)hvp_longest_wait_ms() * NSEC_PER_MSEC);
}

/* Elements of a vector that the board may have; n is the caller's word. */
static int get_vector(struct hvp_board *board, u64 elements, u32 n, hvp_status *status)
{
	const size_t bytes = n * sizeof(*board->vector);

	if (n > board->vector_bytes / sizeof(*board->vector)) {
		*status = HVP_ERROR_ARGUMENT;
		return 0;
	}
	return copy_from_user(board->vector, u64_to_user_ptr(elements), bytes) ? -EFAULT : 0;
}

static int put_vector(struct hvp_board *board, u64 elements, u32 n)
{
	const size_t bytes = n * sizeof(*board->vector);

	return copy_to_user(u64_to_user_ptr(elements), board->vector, bytes) ? -EFAULT : 0;
}

int hvp_call_write_rhs(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	const struct hvp_ioc_vector *given = &call->vector;
	int ret;

	if (given->pad)
		return -EINVAL;
	ret = get_vector(board, given->elements, given->n, status);
	if (!ret && *status == HVP_OK)
		*status = hvp_write_rhs(&board->device, board->vector, given->n);
	return ret;
}

int hvp_call_write_guess(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	const struct hvp_ioc_vector *given = &call->vector;
	int ret;

	if (given->pad)
		return -EINVAL;
	ret = get_vector(board, given->elements, given->n, status);
	if (!ret && *status == HVP_OK)
		*status = hvp_write_initial_guess(&board->device, board->vector, given->n);
	return ret;
}

/* What is left of an earlier job's interrupt must not pass for this one's. */
static hvp_status start_job(struct hvp_board *board)
{
	hvp_status status;

	if (board->device.state != STATE_RUNNING)
		clear_bit(HVP_BOARD_INTERRUPT, &board->flags);
	hvp_engine_give(board);
	status = hvp_start(&board->device);
	if (status != HVP_ERROR_STATE)
		WRITE_ONCE(board->jobs, board->jobs + 1);
	return status;
}

/* An interrupt that came before this look is taken with it, whatever the look finds. */
static hvp_status await_job(struct hvp_board *board, u64 timeout_ns)
{
	hvp_status status;

	if (!timeout_ns)
		clear_bit(HVP_BOARD_INTERRUPT, &board->flags);
	status = hvp_wait(&board->device, wait_limit(timeout_ns));
	if (status == HVP_OK || status == HVP_ERROR_SATURATED)
		hvp_engine_take(board);
	return status;
}

int hvp_call_start(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	*status = start_job(board);
	return 0;
}

int hvp_call_wait(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	if (call->wait.pad)
		return -EINVAL;
	*status = await_job(board, call->wait.timeout_ns);
	call->wait.flags = hvp_last_flags(&board->device);
	return 0;
}

int hvp_call_read_solution(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	const struct hvp_ioc_vector *given = &call->vector;

	if (given->pad)
		return -EINVAL;
	if (given->n > board->vector_bytes / sizeof(*board->vector)) {
		*status = HVP_ERROR_ARGUMENT;
		return 0;
	}
	*status = hvp_read_solution(&board->device, board->vector, given->n);
	return *status == HVP_OK ? put_vector(board, given->elements, given->n) : 0;
}

int hvp_call_read_result(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	struct hvp_result result;

	*status = hvp_read_result(&board->device, &result);
	if (*status != HVP_OK)
		return 0;
	call->result = (struct hvp_ioc_result){
		.cycles = result.cycles,
		.job = result.job,
		.iterations = result.iterations,
		.reached = result.reached,
		.replacements = result.replacements,
		.saturations = result.saturations,
		.wraps = result.wraps,
		.breakdowns = result.breakdowns,
		.flags = result.flags,
	};
	return 0;
}

int hvp_call_solve(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	struct hvp_ioc_solve *given = &call->solve;
	int ret;

	ret = get_vector(board, given->rhs, given->n, status);
	if (ret)
		return ret;
	if (*status == HVP_OK)
		*status = hvp_write_rhs(&board->device, board->vector, given->n);
	if (*status == HVP_OK)
		*status = start_job(board);
	if (*status == HVP_OK) {
		*status = await_job(board, given->timeout_ns);
		given->flags = hvp_last_flags(&board->device);
	}
	if (*status == HVP_OK)
		*status = hvp_read_solution(&board->device, board->vector, given->n);
	return *status == HVP_OK ? put_vector(board, given->solution, given->n) : 0;
}
