// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The calls of the device file that make a job: vectors, the start, the wait, what came of it.
 */
#include <linux/uaccess.h>

#include "driver/hvp_device.h"

#include "hvp_calls.h"

/**
 * hvp_wait_limit() - the longest wait that a call makes
 * @timeout_ns: that a program asks for
 *
 * Return: @timeout_ns, cut to what the module's parameter allows.
 */
u64 hvp_wait_limit(u64 timeout_ns)
{
	return min_t(u64, timeout_ns, (u64)hvp_longest_wait_ms() * NSEC_PER_MSEC);
}

static bool room_for(const struct hvp_board *board, u32 n)
{
	return n <= board->vector_bytes / sizeof(*board->vector);
}

/* What the board cannot have is not copied: the call says why. n is the program's word. */
static int get_vector(struct hvp_board *board, u64 elements, u32 n)
{
	const size_t bytes = n * sizeof(*board->vector);

	if (!room_for(board, n))
		return 0;
	return copy_from_user(board->vector, u64_to_user_ptr(elements), bytes) ? -EFAULT : 0;
}

static int put_vector(struct hvp_board *board, u64 elements, u32 n)
{
	const size_t bytes = n * sizeof(*board->vector);

	return copy_to_user(u64_to_user_ptr(elements), board->vector, bytes) ? -EFAULT : 0;
}

int hvp_bring_vector(struct hvp_board *board, const union hvp_call *call,
		     struct hvp_brought *brought)
{
	if (call->vector.pad)
		return -EINVAL;
	return get_vector(board, call->vector.elements, call->vector.n);
}

int hvp_bring_rhs(struct hvp_board *board, const union hvp_call *call, struct hvp_brought *brought)
{
	return get_vector(board, call->solve.rhs, call->solve.n);
}

/* Nothing but the call's own words. */
int hvp_bring_wait(struct hvp_board *board, const union hvp_call *call,
		   struct hvp_brought *brought)
{
	return call->wait.pad ? -EINVAL : 0;
}

int hvp_bring_place(struct hvp_board *board, const union hvp_call *call,
		    struct hvp_brought *brought)
{
	return call->vector.pad ? -EINVAL : 0;
}

int hvp_give_vector(struct hvp_board *board, const union hvp_call *call)
{
	return put_vector(board, call->vector.elements, call->vector.n);
}

int hvp_give_solution(struct hvp_board *board, const union hvp_call *call)
{
	return put_vector(board, call->solve.solution, call->solve.n);
}

void hvp_call_write_rhs(struct hvp_board *board, union hvp_call *call,
			const struct hvp_brought *brought)
{
	call->head.status = HVP_ERROR_ARGUMENT;
	if (room_for(board, call->vector.n))
		call->head.status =
			hvp_write_rhs(&board->device, board->vector, call->vector.n);
}

void hvp_call_write_guess(struct hvp_board *board, union hvp_call *call,
			  const struct hvp_brought *brought)
{
	call->head.status = HVP_ERROR_ARGUMENT;
	if (room_for(board, call->vector.n))
		call->head.status =
			hvp_write_initial_guess(&board->device, board->vector, call->vector.n);
}

/*
 * What is left of an earlier job's interrupt must not pass for this one's. poll() goes by the job's
 * flag, which is up before the doorbell: the interrupt may come before this returns. note_call()
 * takes it down where nothing was started.
 */
static hvp_status start_job(struct hvp_board *board)
{
	hvp_status status;

	if (board->device.state != STATE_RUNNING)
		clear_bit(HVP_BOARD_INTERRUPT, &board->flags);
	set_bit(HVP_BOARD_RUNNING, &board->flags);
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
	status = hvp_wait(&board->device, hvp_wait_limit(timeout_ns));
	if (status == HVP_OK || status == HVP_ERROR_SATURATED)
		hvp_engine_take(board);
	return status;
}

void hvp_call_start(struct hvp_board *board, union hvp_call *call,
		    const struct hvp_brought *brought)
{
	call->head.status = start_job(board);
}

void hvp_call_wait(struct hvp_board *board, union hvp_call *call,
		   const struct hvp_brought *brought)
{
	call->head.status = await_job(board, call->wait.timeout_ns);
	call->wait.flags = hvp_last_flags(&board->device);
}

void hvp_call_read_solution(struct hvp_board *board, union hvp_call *call,
			    const struct hvp_brought *brought)
{
	call->head.status = HVP_ERROR_ARGUMENT;
	if (room_for(board, call->vector.n))
		call->head.status =
			hvp_read_solution(&board->device, board->vector, call->vector.n);
}

void hvp_call_read_result(struct hvp_board *board, union hvp_call *call,
			  const struct hvp_brought *brought)
{
	struct hvp_result result;

	call->head.status = hvp_read_result(&board->device, &result);
	if (call->head.status != HVP_OK)
		return;
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
}

void hvp_call_solve(struct hvp_board *board, union hvp_call *call,
		    const struct hvp_brought *brought)
{
	struct hvp_ioc_solve *given = &call->solve;
	hvp_status status = HVP_ERROR_ARGUMENT;

	if (room_for(board, given->n))
		status = hvp_write_rhs(&board->device, board->vector, given->n);
	if (status == HVP_OK)
		status = start_job(board);
	if (status == HVP_OK) {
		status = await_job(board, given->timeout_ns);
		given->flags = hvp_last_flags(&board->device);
	}
	if (status == HVP_OK)
		status = hvp_read_solution(&board->device, board->vector, given->n);
	call->head.status = status;
}
