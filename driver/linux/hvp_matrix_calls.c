// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The calls of the device file that bring a matrix, or a part of one.
 */
#include <linux/mm.h>
#include <linux/slab.h>
#include <linux/string.h>

#include "hvp_calls.h"

/* A copy of n elements, to be freed by kvfree(), or an ERR_PTR(). */
static s32 *get_elements(u64 elements, size_t n)
{
	return vmemdup_user(u64_to_user_ptr(elements), n * sizeof(s32));
}

/* What the board cannot hold is not copied: the core says why. */
int hvp_call_load(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	const struct hvp_ioc_matrix *given = &call->matrix;
	const struct hvp_capability *capability = hvp_capability_of(&board->device);
	s32 *row_begin, *column, *value;
	int ret = 0;

	if (given->nodes > capability->max_nodes || given->blocks > capability->max_blocks) {
		*status = HVP_ERROR_CAPABILITY;
		return 0;
	}
	row_begin = get_elements(given->row_begin, given->nodes + 1);
	column = get_elements(given->column, given->blocks);
	value = get_elements(given->value, (size_t)9 * given->blocks);
	if (IS_ERR(row_begin) || IS_ERR(column) || IS_ERR(value)) {
		ret = IS_ERR(row_begin) ? PTR_ERR(row_begin)
		      : IS_ERR(column)	? PTR_ERR(column)
					: PTR_ERR(value);
	} else {
		const struct hvp_matrix matrix = {
			.nodes = given->nodes,
			.blocks = given->blocks,
			.row_begin = row_begin,
			.column = column,
			.value = value,
		};

		*status = hvp_load_matrix(&board->device, &matrix);
	}
	if (!IS_ERR(row_begin))
		kvfree(row_begin);
	if (!IS_ERR(column))
		kvfree(column);
	if (!IS_ERR(value))
		kvfree(value);
	return ret;
}

int hvp_call_constrain(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	*status = hvp_constrain_node(&board->device, call->constraint.node,
				     call->constraint.diagonal);
	return 0;
}

int hvp_call_restore(struct hvp_board *board, union hvp_call *call, hvp_status *status)
{
	const struct hvp_ioc_row *given = &call->row;
	s32 *values;

	if (given->blocks > hvp_capability_of(&board->device)->max_row_blocks) {
		*status = HVP_ERROR_ARGUMENT;
		return 0;
	}
	values = get_elements(given->values, (size_t)9 * given->blocks);
	if (IS_ERR(values))
		return PTR_ERR(values);
	*status = hvp_restore_node(&board->device, given->node, values, given->blocks);
	kvfree(values);
	return 0;
}
