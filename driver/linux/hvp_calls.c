// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The calls of the device file: each takes one of hvp_ioctl.h's structures, brings what it points
 * to into the kernel, and calls the core, with the board's mutex held. Here are those that need
 * nothing brought, and which there are.
 */
#include <linux/kernel.h>

#include "hvp_calls.h"

struct call_entry {
	unsigned int command;
	int (*call)(struct hvp_board *board, union hvp_call *call, hvp_status *status);
};

static int call_info(struct hvp_board *board, union hvp_call *call, hvp_status *status)
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
	return 0;
}

static int call_reset(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	*status = hvp_reset(&board->device);
	return 0;
}

static int call_configure(struct hvp_board *board, union hvp_call *call, hvp_status *status)
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

	if (given->flags & ~HVP_IOC_C_ALL)
		return -EINVAL;
	*status = hvp_configure(&board->device, &config);
	return 0;
}

static int call_statistics(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	const struct hvp_statistics statistics = hvp_statistics_of(&board->device);

	call->statistics = (struct hvp_ioc_statistics){
		.jobs = board->jobs,
		.lost_interrupts = statistics.lost_interrupts,
		.lost_acknowledgements = statistics.lost_acknowledgements,
	};
	return 0;
}

static const struct call_entry calls[] = {
	{HVP_IOC_INFO, call_info},
	{HVP_IOC_RESET, call_reset},
	{HVP_IOC_CONFIGURE, call_configure},
	{HVP_IOC_LOAD, hvp_call_load},
	{HVP_IOC_CONSTRAIN, hvp_call_constrain},
	{HVP_IOC_RESTORE, hvp_call_restore},
	{HVP_IOC_WRITE_RHS, hvp_call_write_rhs},
	{HVP_IOC_WRITE_GUESS, hvp_call_write_guess},
	{HVP_IOC_START, hvp_call_start},
	{HVP_IOC_WAIT, hvp_call_wait},
	{HVP_IOC_READ_SOLUTION, hvp_call_read_solution},
	{HVP_IOC_READ_RESULT, hvp_call_read_result},
	{HVP_IOC_SOLVE, hvp_call_solve},
	{HVP_IOC_STATISTICS, call_statistics},
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

/**
 * hvp_call() - make a call
 * @board: whose mutex is held
 * @command: for which hvp_call_exists()
 * @call: the program's structure; what goes back is filled in, but for its head
 * @status: what the core said
 *
 * Return: 0, or an errno where the call did not come as far as the core.
 */
int hvp_call(struct hvp_board *board, unsigned int command, union hvp_call *call,
	     hvp_status *status)
{
	size_t i = 0;

	*status = HVP_OK;
	if (hvp_board_lost(board) && !needs_no_board(command)) {
		*status = test_bit(HVP_BOARD_GONE, &board->flags) ? HVP_ERROR_NO_DEVICE
								  : HVP_ERROR_BUS;
		return 0;
	}
	while (calls[i].command != command)
		i++;
	return calls[i].call(board, call, status);
}
