// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The calls of the device file: each takes one of hvp_ioctl.h's structures, brings what it points
 * to into the kernel, asks the core, and gives back what the program wants. Here are those that
 * need nothing brought, and which there are.
 */
#include <linux/kernel.h>
#include <linux/mm.h>

#include "driver/hvp_device.h"
#include "driver/hvp_errno.h"

#include "hvp_calls.h"

/* struct hvp_brought of hvp_calls.h says what the three do; NULL where there is nothing to do. */
struct call_entry {
	unsigned int command;
	void (*call)(struct hvp_board *board, union hvp_call *call,
		     const struct hvp_brought *brought);
	int (*bring)(struct hvp_board *board, const union hvp_call *call,
		     struct hvp_brought *brought);
	int (*give)(struct hvp_board *board, const union hvp_call *call);
};

static void call_info(struct hvp_board *board, union hvp_call *call,
		      const struct hvp_brought *brought)
{
	const struct hvp_capability *capability = hvp_capability_of(&board->device);
	const struct hvp_engine_memory *engine = &board->engine;

	call->info = (struct hvp_ioc_info){
		.abi = HVP_IOC_ABI,
		.flags = (engine->usable ? HVP_IOC_F_DMA : 0) |
			 (board->by_message ? HVP_IOC_F_MSI : 0) |
			 (board->irq < 0 ? HVP_IOC_F_POLLED : 0),
		.max_nodes = capability->max_nodes,
		.max_row_blocks = capability->max_row_blocks,
		.max_blocks = capability->max_blocks,
		.max_matrix_bits = capability->max_matrix_bits,
		.max_vector_bits = capability->max_vector_bits,
		.max_rhs_bits = capability->max_rhs_bits,
		.max_coefficient_bits = capability->max_coefficient_bits,
		.clock_khz = capability->clock_khz,
		.methods = capability->methods,
		.start_modes = capability->start_modes,
		.max_scalar_bits = capability->max_scalar_bits,
		.max_timeout_ms = hvp_longest_wait_ms(),
		.rhs_bytes = engine->usable ? engine->to_board.bytes : 0,
		.solution_bytes = engine->usable ? engine->to_host.bytes : 0,
	};
}

static void call_reset(struct hvp_board *board, union hvp_call *call,
		       const struct hvp_brought *brought)
{
	call->head.status = hvp_reset(&board->device);
}

static int bring_config(struct hvp_board *board, const union hvp_call *call,
			struct hvp_brought *brought)
{
	return call->config.flags & ~HVP_IOC_C_ALL ? -EINVAL : 0;
}

static void call_configure(struct hvp_board *board, union hvp_call *call,
			   const struct hvp_brought *brought)
{
	const struct hvp_ioc_config *given = &call->config;
	const struct hvp_solver_config config = {
		.method = given->method,
		.start = given->start,
		.iterations = given->iterations,
		.stop_residual = given->stop_residual,
		.replace_every = given->replace_every,
		.static_shift = given->static_shift,
		.dynamic_scaling = given->flags & HVP_IOC_C_DYNAMIC_SCALING,
		.scaling_up_only = given->flags & HVP_IOC_C_SCALING_UP_ONLY,
		.headroom_bits = given->headroom_bits,
		.scaling_threshold = given->scaling_threshold,
		.scaling_step = given->scaling_step,
		.matrix_bits = given->matrix_bits,
		.vector_bits = given->vector_bits,
		.rhs_bits = given->rhs_bits,
		.scalar_bits = given->scalar_bits,
		.coefficient_bits = given->coefficient_bits,
		.fixed_coefficients = given->flags & HVP_IOC_C_FIXED_COEFFICIENTS,
		.alpha_fraction = given->alpha_fraction,
		.beta_fraction = given->beta_fraction,
		.division_rounding = given->division_rounding,
		.shift_rounding = given->shift_rounding,
		.one_a_word = given->flags & HVP_IOC_C_ONE_A_WORD,
		.wrap_overflow = given->flags & HVP_IOC_C_WRAP_OVERFLOW,
		.reject_saturated = given->flags & HVP_IOC_C_REJECT_SATURATED,
	};

	call->head.status = hvp_configure(&board->device, &config);
}

static void call_statistics(struct hvp_board *board, union hvp_call *call,
			    const struct hvp_brought *brought)
{
	const struct hvp_statistics statistics = hvp_statistics_of(&board->device);

	call->statistics = (struct hvp_ioc_statistics){
		.jobs = board->jobs,
		.lost_interrupts = statistics.lost_interrupts,
		.lost_acknowledgements = statistics.lost_acknowledgements,
	};
}

static const struct call_entry calls[] = {
	{HVP_IOC_INFO, call_info, NULL, NULL},
	{HVP_IOC_RESET, call_reset, NULL, NULL},
	{HVP_IOC_CONFIGURE, call_configure, bring_config, NULL},
	{HVP_IOC_LOAD, hvp_call_load, hvp_bring_matrix, NULL},
	{HVP_IOC_CONSTRAIN, hvp_call_constrain, NULL, NULL},
	{HVP_IOC_RESTORE, hvp_call_restore, hvp_bring_row, NULL},
	{HVP_IOC_WRITE_RHS, hvp_call_write_rhs, hvp_bring_vector, NULL},
	{HVP_IOC_WRITE_GUESS, hvp_call_write_guess, hvp_bring_vector, NULL},
	{HVP_IOC_START, hvp_call_start, NULL, NULL},
	{HVP_IOC_WAIT, hvp_call_wait, hvp_bring_wait, NULL},
	{HVP_IOC_READ_SOLUTION, hvp_call_read_solution, hvp_bring_place, hvp_give_vector},
	{HVP_IOC_READ_RESULT, hvp_call_read_result, NULL, NULL},
	{HVP_IOC_SOLVE, hvp_call_solve, hvp_bring_rhs, hvp_give_solution},
	{HVP_IOC_STATISTICS, call_statistics, NULL, NULL},
	{HVP_IOC_UPDATE, hvp_call_update, hvp_bring_values, NULL},
};

/* Needs no board that answers. */
static bool needs_no_board(unsigned int command)
{
	return command == HVP_IOC_INFO || command == HVP_IOC_STATISTICS;
}

/**
 * hvp_call_exists() - whether there is such a call
 * @command: of an ioctl
 *
 * Return: whether hvp_call() knows @command, and the size that it has.
 */
bool hvp_call_exists(unsigned int command)
{
	size_t i;

	for (i = 0; i < ARRAY_SIZE(calls); i++) {
		if (calls[i].command == command)
			return true;
	}
	return false;
}

/* Whether it hears of a job's end, or of its loss, or ends it. */
static bool takes_end(unsigned int command)
{
	return command == HVP_IOC_START || command == HVP_IOC_WAIT || command == HVP_IOC_SOLVE ||
	       command == HVP_IOC_RESET;
}

/* What poll() goes by. A job that was lost under a program stays until the program hears of it. */
static void note_call(struct hvp_board *board, unsigned int command, hvp_status status)
{
	if (board->device.state == STATE_RUNNING)
		set_bit(HVP_BOARD_RUNNING, &board->flags);
	else if (takes_end(command))
		clear_bit(HVP_BOARD_RUNNING, &board->flags);
	if (status == HVP_OK || status == HVP_ERROR_INTERRUPTED)
		return;
	WRITE_ONCE(board->last_error, status);
	WRITE_ONCE(board->last_detail, hvp_error_detail(&board->device));
}

/*
 * A wait that a signal ended goes on by itself where no handler ran, as after a suspend or under a
 * debugger. A load may always be repeated, and so may an update of values; the two halves of a
 * solve may not.
 */
static long result_of(const struct hvp_board *board, unsigned int command, hvp_status status)
{
	if (status != HVP_ERROR_INTERRUPTED)
		return -hvp_errno_of(status);
	switch (command) {
	case HVP_IOC_LOAD:
	case HVP_IOC_UPDATE:
		return hvp_caller_error(&board->device);
	case HVP_IOC_WAIT:
		return -ERESTARTNOHAND;
	default:
		return -EINTR;
	}
}

static long ask(struct hvp_board *board, const struct call_entry *entry, union hvp_call *call,
		const struct hvp_brought *brought)
{
	long ret;

	mutex_lock(&board->mutex);
	if (hvp_board_lost(board) && !needs_no_board(entry->command))
		call->head.status = test_bit(HVP_BOARD_GONE, &board->flags) ? HVP_ERROR_NO_DEVICE
									    : HVP_ERROR_BUS;
	else
		entry->call(board, call, brought);
	call->head.detail = hvp_error_detail(&board->device);
	note_call(board, entry->command, call->head.status);
	ret = result_of(board, entry->command, call->head.status);
	mutex_unlock(&board->mutex);
	return ret;
}

/**
 * hvp_call() - make a call
 * @board: whose @calls is held
 * @command: for which hvp_call_exists()
 * @call: the program's structure; what goes back is filled in where the core was asked
 *
 * Return: 0 or an errno. The head's status is %HVP_STATUS_COUNT where the core was not asked, or
 * where the program did not get what it said.
 */
long hvp_call(struct hvp_board *board, unsigned int command, union hvp_call *call)
{
	struct hvp_brought brought = {};
	const struct call_entry *entry = calls;
	long ret = 0;
	size_t i;

	while (entry->command != command)
		entry++;
	call->head.status = HVP_STATUS_COUNT;
	if (entry->bring)
		ret = entry->bring(board, call, &brought);
	if (!ret) {
		ret = ask(board, entry, call, &brought);
		if (!ret && entry->give) {
			ret = entry->give(board, call);
			if (ret)
				call->head.status = HVP_STATUS_COUNT;
		}
	}
	for (i = 0; i < ARRAY_SIZE(brought.elements); i++)
		kvfree(brought.elements[i]);
	return ret;
}
