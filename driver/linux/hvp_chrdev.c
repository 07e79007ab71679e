// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The device file /dev/hvpN (hvp_ioctl.h): one program at a time, whose calls are serialised.
 */
#include <linux/fs.h>
#include <linux/idr.h>
#include <linux/mm.h>
#include <linux/module.h>
#include <linux/poll.h>
#include <linux/uaccess.h>

#include "hvp_module.h"
#include "hvp_calls.h"

static DEFINE_IDA(numbers);

static int open_file(struct inode *inode, struct file *file)
{
	struct hvp_board *board = container_of(file->private_data, struct hvp_board, file);

	if (test_bit(HVP_BOARD_GONE, &board->flags))
		return -ENODEV;
	if (test_and_set_bit_lock(HVP_BOARD_OPENED, &board->flags))
		return -EBUSY;
	hvp_board_get(board);
	file->private_data = board;
	return stream_open(inode, file);
}

/* The next program finds nothing of this one's: neither a job that runs nor a matrix, b or U. */
static int release_file(struct inode *inode, struct file *file)
{
	struct hvp_board *board = file->private_data;

	mutex_lock(&board->mutex);
	WRITE_ONCE(board->engine.mapped, false);
	if (!hvp_board_lost(board))
		(void)hvp_reset(&board->device);
	clear_bit(HVP_BOARD_RUNNING, &board->flags);
	if (!test_bit(HVP_BOARD_GONE, &board->flags))
		hvp_engine_forget(board);
	memset(board->vector, 0, board->vector_bytes);
	mutex_unlock(&board->mutex);
	clear_bit_unlock(HVP_BOARD_OPENED, &board->flags);
	hvp_board_put(board);
	return 0;
}

static long file_ioctl(struct file *file, unsigned int command, unsigned long argument)
{
	struct hvp_board *board = file->private_data;
	void __user *given = (void __user *)argument;
	union hvp_call call = {};
	bool asked;
	long ret;

	if (!hvp_call_exists(command))
		return -ENOTTY;
	if (copy_from_user(&call, given, _IOC_SIZE(command)))
		return -EFAULT;
	/* Nothing was asked yet: where no handler runs, as after a suspend, it begins anew. */
	if (mutex_lock_interruptible(&board->calls))
		return -ERESTARTSYS;
	ret = hvp_call(board, command, &call);
	asked = call.head.status != HVP_STATUS_COUNT;
	mutex_unlock(&board->calls);
	if (!asked)
		return ret;
	return copy_to_user(given, &call, _IOC_SIZE(command)) ? -EFAULT : ret;
}

static __poll_t poll_file(struct file *file, poll_table *table)
{
	struct hvp_board *board = file->private_data;
	unsigned long flags;

	poll_wait(file, &board->wait, table);
	flags = READ_ONCE(board->flags);
	if (flags & BIT(HVP_BOARD_GONE))
		return EPOLLHUP | EPOLLERR;
	if (!(flags & BIT(HVP_BOARD_RUNNING)))
		return 0;
	/* Without interrupts nobody would wake who waits here: the look is HVP_IOC_WAIT's. */
	if (board->irq < 0 || flags & (BIT(HVP_BOARD_INTERRUPT) | BIT(HVP_BOARD_FROZEN)))
		return EPOLLIN | EPOLLRDNORM;
	return 0;
}

static int map_engine(struct hvp_board *board, struct vm_area_struct *area)
{
	const u64 offset = (u64)area->vm_pgoff << PAGE_SHIFT;

	if (test_bit(HVP_BOARD_GONE, &board->flags) || !board->engine.usable)
		return -ENODEV;
	if (!(area->vm_flags & VM_SHARED))
		return -EINVAL;
	if (offset == HVP_IOC_MAP_RHS)
		return hvp_engine_map(board, &board->engine.to_board, area);
	if (offset != HVP_IOC_MAP_SOLUTION)
		return -EINVAL;
	if (area->vm_flags & VM_WRITE)
		return -EACCES;
	vm_flags_clear(area, VM_MAYWRITE);
	return hvp_engine_map(board, &board->engine.to_host, area);
}

static int map_file(struct file *file, struct vm_area_struct *area)
{
	struct hvp_board *board = file->private_data;
	int ret;

	mutex_lock(&board->map_mutex);
	ret = map_engine(board, area);
	mutex_unlock(&board->map_mutex);
	return ret;
}

static const struct file_operations operations = {
	.owner = THIS_MODULE,
	.open = open_file,
	.release = release_file,
	.unlocked_ioctl = file_ioctl,
	.compat_ioctl = compat_ptr_ioctl,
	.poll = poll_file,
	.mmap = map_file,
};

/**
 * hvp_chrdev_add() - make the board's device file, the last thing before it is in use
 * @board: ready for calls
 *
 * Return: 0 or an errno.
 */
int hvp_chrdev_add(struct hvp_board *board)
{
	int ret = ida_alloc(&numbers, GFP_KERNEL);

	if (ret < 0)
		return ret;
	board->number = ret;
	snprintf(board->name, sizeof(board->name), "hvp%d", board->number);
	board->file = (struct miscdevice){
		.minor = MISC_DYNAMIC_MINOR,
		.name = board->name,
		.fops = &operations,
		.parent = &board->function->dev,
	};
	ret = misc_register(&board->file);
	if (ret)
		ida_free(&numbers, board->number);
	return ret;
}

/**
 * hvp_chrdev_remove() - take the device file away; who has it open keeps it
 * @board: for which hvp_chrdev_add() returned 0
 */
void hvp_chrdev_remove(struct hvp_board *board)
{
	misc_deregister(&board->file);
	ida_free(&numbers, board->number);
}
