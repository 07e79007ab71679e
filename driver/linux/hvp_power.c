// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * A board that is away for a while: asleep, behind a bus that has failed, or in a reset of its
 * function. What comes back has neither settings nor a matrix.
 */
#include <linux/pci.h>
#include <linux/pm.h>

#include "driver/hvp_errno.h"

#include "hvp_module.h"

/**
 * hvp_board_take_away() - let nobody ask anything of the board, and nobody wait for it
 * @board: whose mutex is taken; the caller gives it back
 * @flag: %HVP_BOARD_GONE or %HVP_BOARD_FROZEN
 *
 * Whoever waits lets the mutex go; whoever comes later finds the flag.
 */
void hvp_board_take_away(struct hvp_board *board, enum hvp_board_flag flag)
{
	set_bit(flag, &board->flags);
	wake_up_all(&board->wait);
	mutex_lock(&board->mutex);
}

/*
 * Settings and matrix are lost with the power; the engine's memory is told to the board again. A
 * job that ran is lost too, and no interrupt will tell: who waits for it by poll() is woken here,
 * and the wait that follows says so.
 */
static int bring_back(struct hvp_board *board)
{
	hvp_status status;

	mutex_lock(&board->mutex);
	status = hvp_reset(&board->device);
	set_bit(HVP_BOARD_INTERRUPT, &board->flags);
	wake_up_all(&board->wait);
	if (status == HVP_OK)
		clear_bit(HVP_BOARD_FROZEN, &board->flags);
	mutex_unlock(&board->mutex);
	if (status != HVP_OK)
		dev_err(&board->function->dev, "not back: %s\n", hvp_status_text(status));
	return -hvp_errno_of(status);
}

static int hvp_suspend(struct device *dev)
{
	struct hvp_board *board = dev_get_drvdata(dev);

	hvp_board_take_away(board, HVP_BOARD_FROZEN);
	(void)hvp_reset(&board->device);
	mutex_unlock(&board->mutex);
	return 0;
}

static int hvp_resume(struct device *dev)
{
	return bring_back(dev_get_drvdata(dev));
}

DEFINE_SIMPLE_DEV_PM_OPS(hvp_pm_ops, hvp_suspend, hvp_resume);

static pci_ers_result_t hvp_error_detected(struct pci_dev *function, pci_channel_state_t state)
{
	struct hvp_board *board = pci_get_drvdata(function);

	hvp_board_take_away(board, state == pci_channel_io_perm_failure ? HVP_BOARD_GONE :
									  HVP_BOARD_FROZEN);
	mutex_unlock(&board->mutex);
	if (state == pci_channel_io_perm_failure)
		return PCI_ERS_RESULT_DISCONNECT;
	/* What the board has of the job, or of the matrix, is not known even where it answers. */
	return PCI_ERS_RESULT_NEED_RESET;
}

static pci_ers_result_t hvp_slot_reset(struct pci_dev *function)
{
	/* The state of the end of the probe: the BAR, memory space and bus mastering, messages. */
	pci_restore_state(function);
	pci_save_state(function);
	return PCI_ERS_RESULT_RECOVERED;
}

static void hvp_error_resume(struct pci_dev *function)
{
	struct hvp_board *board = pci_get_drvdata(function);

	if (bring_back(board)) {
		set_bit(HVP_BOARD_GONE, &board->flags);
		wake_up_all(&board->wait);
	}
}

static void hvp_reset_prepare(struct pci_dev *function)
{
	struct hvp_board *board = pci_get_drvdata(function);

	hvp_board_take_away(board, HVP_BOARD_FROZEN);
	mutex_unlock(&board->mutex);
}

const struct pci_error_handlers hvp_error_handlers = {
	.error_detected = hvp_error_detected,
	.slot_reset = hvp_slot_reset,
	.resume = hvp_error_resume,
	.reset_prepare = hvp_reset_prepare,
	.reset_done = hvp_error_resume,
};
