// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The core's way to the board: accesses to the BAR, the interrupt and the clock.
 */
#include <linux/delay.h>
#include <linux/hrtimer.h>
#include <linux/interrupt.h>
#include <linux/io.h>
#include <linux/ktime.h>
#include <linux/sched/signal.h>

#include "driver/generated/hvp_registers.h"

#include "hvp_module.h"

static u32 bar_read32(void *context, u32 offset)
{
	const struct hvp_board *board = context;

	return ioread32(board->bar + offset);
}

static void bar_write32(void *context, u32 offset, u32 value)
{
	const struct hvp_board *board = context;

	iowrite32(value, board->bar + offset);
}

/*
 * memcpy_fromio() and memcpy_toio() make bursts of whole words out of what is aligned, as all of
 * the core's blocks are, but they copy bytes: on a host of the other byte order each word is
 * turned.
 */
static void bar_read_block(void *context, u32 offset, u32 *words, size_t count)
{
	const struct hvp_board *board = context;
	size_t i;

	if (!IS_ENABLED(CONFIG_CPU_BIG_ENDIAN)) {
		memcpy_fromio(words, board->bar + offset, count * sizeof(*words));
		return;
	}
	for (i = 0; i < count; i++)
		words[i] = ioread32(board->bar + offset + i * sizeof(*words));
}

static void bar_write_block(void *context, u32 offset, const u32 *words, size_t count)
{
	const struct hvp_board *board = context;
	size_t i;

	if (!IS_ENABLED(CONFIG_CPU_BIG_ENDIAN)) {
		memcpy_toio(board->bar + offset, words, count * sizeof(*words));
		return;
	}
	for (i = 0; i < count; i++)
		iowrite32(words[i], board->bar + offset + i * sizeof(*words));
}

static bool woken(struct hvp_board *board)
{
	return hvp_board_lost(board) || test_and_clear_bit(HVP_BOARD_INTERRUPT, &board->flags);
}

/*
 * A signal ends the wait with -ERESTARTSYS, which the core hands on to the caller of the system
 * call. A board that was taken away ends it too: the mutex is wanted by who took it.
 */
static int bar_wait_interrupt(void *context, u64 timeout_ns)
{
	struct hvp_board *board = context;
	const ktime_t timeout = ns_to_ktime(min_t(u64, timeout_ns, KTIME_MAX));
	int outcome;

	outcome = wait_event_interruptible_hrtimeout(board->wait, woken(board), timeout);
	if (hvp_board_lost(board))
		return HVP_INTERRUPT_BUS_FAILED;
	return outcome == -ETIME ? HVP_INTERRUPT_TIMED_OUT : outcome;
}

/*
 * Without an interrupt each return is a look at the board, or at the record in memory. A frame
 * lasts a few hundred microseconds: a look every ten costs little and delays little.
 */
static int bar_wait_look(void *context, u64 timeout_ns)
{
	struct hvp_board *board = context;

	usleep_range(5, 10);
	if (hvp_board_lost(board))
		return HVP_INTERRUPT_BUS_FAILED;
	return signal_pending(current) ? -ERESTARTSYS : HVP_INTERRUPT;
}

static u64 bar_now_ns(void *context)
{
	return ktime_get_ns();
}

static void note_status_register(u16 *noted, u16 status)
{
	*noted |= status & (PCI_STATUS_REC_MASTER_ABORT | PCI_STATUS_DETECTED_PARITY);
}

/*
 * What the function has noted, and the bridge above it where there is one: an access that nobody
 * answers is the bridge's to notice. The bits are cleared by writing ones, and only those seen.
 */
static u32 bar_take_errors(void *context)
{
	struct hvp_board *board = context;
	struct pci_dev *bridge = pci_upstream_bridge(board->function);
	u16 noted = 0;
	u32 errors = 0;
	u16 status;

	if (pci_read_config_word(board->function, PCI_STATUS, &status) ||
	    PCI_POSSIBLE_ERROR(status)) {
		/* The function was pulled out: what was read since is not the board's. */
		errors |= HVP_BUS_MASTER_ABORT;
	} else {
		note_status_register(&noted, status);
		if (noted)
			pci_write_config_word(board->function, PCI_STATUS, noted);
	}
	if (bridge && !pci_read_config_word(bridge, PCI_SEC_STATUS, &status) &&
	    !PCI_POSSIBLE_ERROR(status)) {
		u16 above = 0;

		note_status_register(&above, status);
		if (above)
			pci_write_config_word(bridge, PCI_SEC_STATUS, above);
		noted |= above;
	}
	if (noted & PCI_STATUS_REC_MASTER_ABORT)
		errors |= HVP_BUS_MASTER_ABORT;
	if (noted & PCI_STATUS_DETECTED_PARITY)
		errors |= HVP_BUS_PARITY;
	return errors;
}

static void bar_lock(void *context) __acquires(&board->line_lock)
{
	struct hvp_board *board = context;
	unsigned long flags;

	spin_lock_irqsave(&board->line_lock, flags);
	board->line_flags = flags;
}

static void bar_unlock(void *context) __releases(&board->line_lock)
{
	struct hvp_board *board = context;

	spin_unlock_irqrestore(&board->line_lock, board->line_flags);
}

/**
 * hvp_bar_bus() - the core's call-backs for a board
 * @board: with its BAR, and its interrupt or none
 * @takes_errors: the bus is asked what has gone wrong on it
 *
 * A record that is looked for in memory is whole when it is there: a board that is polled needs no
 * read in front of it, as with messages.
 *
 * Return: what hvp_open() takes.
 */
struct hvp_bus hvp_bar_bus(struct hvp_board *board, bool takes_errors)
{
	return (struct hvp_bus){
		.context = board,
		.read32 = bar_read32,
		.write32 = bar_write32,
		.read_block = bar_read_block,
		.write_block = bar_write_block,
		.wait_interrupt = board->irq < 0 ? bar_wait_look : bar_wait_interrupt,
		.now_ns = bar_now_ns,
		.interrupts_after_writes = board->irq < 0 || board->by_message,
		.take_errors = takes_errors ? bar_take_errors : NULL,
		.lock = bar_lock,
		.unlock = bar_unlock,
	};
}

/**
 * hvp_bar_interrupt() - the handler
 * @irq: Linux' number
 * @context: the board
 *
 * A message is always the board's and needs no access. A line may be a neighbour's: the core looks,
 * and masks it until the thread has dealt with what raised it. Nobody looks at a board that sleeps
 * or is cut off.
 *
 * Return: %IRQ_HANDLED, or %IRQ_NONE where the interrupt is not the board's.
 */
irqreturn_t hvp_bar_interrupt(int irq, void *context)
{
	struct hvp_board *board = context;

	if (hvp_board_lost(board))
		return IRQ_NONE;
	if (hvp_irq(&board->device, !board->by_message) == HVP_IRQ_NONE) {
		/*
		 * To a virtual machine a line is up until the next access to the BAR. The one
		 * with which the core looked at the line came before the board was masked, so
		 * that it may have been raised once more: without an access for that it stays up.
		 */
		if (!board->by_message)
			bar_read32(board, offsetof(hvp_t, INTERRUPT_STATUS));
		return IRQ_NONE;
	}
	atomic_inc(&board->interrupts);
	set_bit(HVP_BOARD_INTERRUPT, &board->flags);
	wake_up_all(&board->wait);
	return IRQ_HANDLED;
}
