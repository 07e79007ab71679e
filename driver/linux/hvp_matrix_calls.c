// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The calls of the device file that bring a matrix, or a part of one.
 */
#include <linux/mm.h>
#include <linux/slab.h>
#include <linux/string.h>

#include "hvp_calls.h"

/* A copy of n elements of the program's. */
static int bring(s32 **copy, u64 elements, size_t n)
{
	s32 *made = vmemdup_user(u64_to_user_ptr(elements), n * sizeof(s32));

	if (IS_ERR(made))
		return PTR_ERR(made);
	*copy = made;
	return 0;
}

/* What the board cannot hold is not copied: the call says why. */
static bool fits(const struct hvp_board *board, const struct hvp_ioc_matrix *given)
{
	const struct hvp_capability *capability = hvp_capability_of(&board->device);

	return given->nodes <= capability->max_nodes && given->blocks <= capability->max_blocks;
}

int hvp_bring_matrix(struct hvp_board *board, const union hvp_call *call,
		     struct hvp_brought *brought)
{
	const struct hvp_ioc_matrix *given = &call->matrix;
	int ret;

	if (!fits(board, given))
		return 0;
	ret = bring(&brought->elements[0], given->row_begin, given->nodes + 1);
	if (!ret)
		ret = bring(&brought->elements[1], given->column, given->blocks);
	if (!ret)
		ret = bring(&brought->elements[2], given->value, (size_t)9 * given->blocks);
	return ret;
}

void hvp_call_load(struct hvp_board *board, union hvp_call *call,
		   const struct hvp_brought *brought)
{
	const struct hvp_matrix matrix = {
		.nodes = call->matrix.nodes,
		.blocks = call->matrix.blocks,
		.row_begin = brought->elements[0],
		.column = brought->elements[1],
		.value = brought->elements[2],
	};

	call->head.status = HVP_ERROR_CAPABILITY;
	if (fits(board, &call->matrix))
		call->head.status = hvp_load_matrix(&board->device, &matrix);
}

static bool values_fit(const struct hvp_board *board, const struct hvp_ioc_values *given)
{
	return given->n <= (u64)9 * hvp_capability_of(&board->device)->max_blocks;
}

int hvp_bring_values(struct hvp_board *board, const union hvp_call *call,
		     struct hvp_brought *brought)
{
	const struct hvp_ioc_values *given = &call->values;

	if (given->pad)
		return -EINVAL;
	if (!values_fit(board, given))
		return 0;
	return bring(&brought->elements[0], given->values, given->n);
}

void hvp_call_update(struct hvp_board *board, union hvp_call *call,
		     const struct hvp_brought *brought)
{
	const struct hvp_ioc_values *given = &call->values;

	call->head.status = HVP_ERROR_ARGUMENT;
	if (!values_fit(board, given))
		return;
	hvp_engine_hold_values(board);
	call->head.status = hvp_update_values(&board->device, brought->elements[0], given->n,
					      hvp_wait_limit(given->timeout_ns));
}

void hvp_call_constrain(struct hvp_board *board, union hvp_call *call,
			const struct hvp_brought *brought)
{
	call->head.status = hvp_constrain_node(&board->device, call->constraint.node,
					       call->constraint.diagonal);
}

static bool row_fits(const struct hvp_board *board, const struct hvp_ioc_row *given)
{
	return given->blocks <= hvp_capability_of(&board->device)->max_row_blocks;
}

int hvp_bring_row(struct hvp_board *board, const union hvp_call *call, struct hvp_brought *brought)
{
	const struct hvp_ioc_row *given = &call->row;

	if (!row_fits(board, given))
		return 0;
	return bring(&brought->elements[0], given->values, (size_t)9 * given->blocks);
}

void hvp_call_restore(struct hvp_board *board, union hvp_call *call,
		      const struct hvp_brought *brought)
{
	const struct hvp_ioc_row *given = &call->row;

	call->head.status = HVP_ERROR_ARGUMENT;
	if (row_fits(board, given))
		call->head.status = hvp_restore_node(&board->device, given->node,
						     brought->elements[0], given->blocks);
}
