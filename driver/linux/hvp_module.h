/* SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0 */
#ifndef HVP_MODULE_H
#define HVP_MODULE_H

#include <linux/bitops.h>
#include <linux/interrupt.h>
#include <linux/kref.h>
#include <linux/miscdevice.h>
#include <linux/mutex.h>
#include <linux/pci.h>
#include <linux/spinlock.h>
#include <linux/wait.h>

#include "driver/hvp_driver.h"

/* What kernels from 6.1 to 6.12 have renamed (Kbuild). */
#ifndef PCI_IRQ_INTX
#define PCI_IRQ_INTX PCI_IRQ_LEGACY
#endif
#ifndef HVP_HAS_VM_FLAGS_CLEAR
#define vm_flags_clear(area, flags) ((area)->vm_flags &= ~(flags))
#endif

/*
 * What the parts of the module share about a board: the function on the bus (hvp_pci.c,
 * hvp_power.c), the core's call-backs (hvp_bar.c), memory for its engine (hvp_engine.c), the device
 * file (hvp_chrdev.c) and the attributes (hvp_sysfs.c). The core, in driver/, knows none of them.
 */

/**
 * struct hvp_values_memory - what the board's DMA engine fetches new entries of a matrix from
 * @group: of the device's resources
 * @list: its descriptors; coherent
 * @list_address: where the board sees @list
 * @count: of @segments
 * @bytes: of all of them
 * @segments: the entries as they travel
 */
struct hvp_values_memory {
	void *group;
	u32 *list;
	dma_addr_t list_address;
	size_t count;
	size_t bytes;
	struct hvp_segment segments[];
};

/**
 * struct hvp_engine_memory - what the board's DMA engine works in
 * @usable: all of it is there, and the board has an engine
 * @mapped: a program has mapped b or U, and may still
 * @to_board: b as it travels; whole pages
 * @to_host: U likewise
 * @values: made when a program first updates values of so large a matrix; NULL before
 * @shared: the list of descriptors, then the completion record; coherent
 * @shared_address: where the board sees @shared
 */
struct hvp_engine_memory {
	bool usable;
	bool mapped;
	struct hvp_segment to_board;
	struct hvp_segment to_host;
	struct hvp_values_memory *values;
	u32 *shared;
	dma_addr_t shared_address;
};

/**
 * enum hvp_board_flag - bits of &hvp_board.flags
 * @HVP_BOARD_GONE: removed, or failed for good; never cleared
 * @HVP_BOARD_FROZEN: its accesses are blocked until an error has been recovered from
 * @HVP_BOARD_INTERRUPT: an interrupt came that no wait has taken yet
 * @HVP_BOARD_RUNNING: a job was started whose end no wait has seen
 * @HVP_BOARD_OPENED: a process has the device file
 */
enum hvp_board_flag {
	HVP_BOARD_GONE,
	HVP_BOARD_FROZEN,
	HVP_BOARD_INTERRUPT,
	HVP_BOARD_RUNNING,
	HVP_BOARD_OPENED,
};

/**
 * struct hvp_board - a board and all that was made for it
 * @references: of the function's driver, and one of each open file
 * @function: valid until @flags has %HVP_BOARD_GONE and @mutex was taken once
 * @bar: mapped as long as @function is valid
 * @irq: Linux' number, or a negative one where the board is polled
 * @by_message: the interrupt is a message, nobody else's and behind the board's writes
 * @flags: bits of &enum hvp_board_flag
 * @calls: held by a program's call from its begin to its end, so that one follows the other; guards
 *	@vector. Outside @mutex: who takes the board away does not wait for a program's memory
 * @mutex: held around every call into the core but hvp_irq(), and never while a program's memory is
 *	touched; guards @device, @scratch, @jobs, @last_error and @last_detail
 * @map_mutex: held while a program's memory is mapped; @engine is there while %HVP_BOARD_GONE is
 *	not set under it. Not @calls, which is held while a program's memory is touched, which is
 *	locked when a file is mapped
 * @line_lock: the core's, for what hvp_irq() and a thread both touch
 * @line_flags: of who holds @line_lock
 * @wait: who waits for an interrupt, or for what took the board away
 * @interrupts: taken so far
 * @device: the core's handle
 * @scratch: where the core packs bursts; linear, since a bus may map it
 * @engine: memory for DMA
 * @vector: b, a guess or U on its way from or to a program, an element in 32 bits
 * @vector_bytes: of @vector: what the largest matrix takes
 * @jobs: started so far
 * @last_error: last status of a job that was none of success
 * @last_detail: the number that goes with @last_error
 * @number: of the device file
 * @file: the device file
 * @name: its name
 */
struct hvp_board {
	struct kref references;
	struct pci_dev *function;
	void __iomem *bar;
	int irq;
	bool by_message;
	unsigned long flags;
	struct mutex calls;	/* of programs */
	struct mutex mutex;	/* calls into the core */
	struct mutex map_mutex; /* mapping, against removal */
	spinlock_t line_lock;	/* handler and thread */
	unsigned long line_flags;
	wait_queue_head_t wait;
	atomic_t interrupts;
	struct hvp_device device;
	u32 *scratch;
	struct hvp_engine_memory engine;
	s32 *vector;
	size_t vector_bytes;
	u64 jobs;
	hvp_status last_error;
	u32 last_detail;
	int number;
	struct miscdevice file;
	char name[16];
};

/* Whether nothing may be asked of the board: for good, or for now. */
static inline bool hvp_board_lost(const struct hvp_board *board)
{
	return (READ_ONCE(board->flags) & (BIT(HVP_BOARD_GONE) | BIT(HVP_BOARD_FROZEN))) != 0;
}

/* How its ends are heard of, in a word. */
static inline const char *hvp_interrupt_name(const struct hvp_board *board)
{
	if (board->irq < 0)
		return "polled";
	if (!board->by_message)
		return "intx";
	return board->function->msix_enabled ? "msi-x" : "msi";
}

/* hvp_pci.c */
void hvp_board_get(struct hvp_board *board);
void hvp_board_put(struct hvp_board *board);
unsigned int hvp_longest_wait_ms(void);

/* hvp_power.c */
extern const struct dev_pm_ops hvp_pm_ops;
extern const struct pci_error_handlers hvp_error_handlers;
void hvp_board_take_away(struct hvp_board *board, enum hvp_board_flag flag);

/* hvp_bar.c */
struct hvp_bus hvp_bar_bus(struct hvp_board *board, bool takes_errors);
irqreturn_t hvp_bar_interrupt(int irq, void *context);

/* hvp_engine.c: a segment each way */
#define HVP_ENGINE_DESCRIPTORS 2
int hvp_engine_make(struct hvp_board *board);
hvp_status hvp_engine_use(struct hvp_board *board);
void hvp_engine_hold_values(struct hvp_board *board);
void hvp_engine_forget(struct hvp_board *board);
void hvp_engine_give(struct hvp_board *board);
void hvp_engine_take(struct hvp_board *board);
int hvp_engine_map(struct hvp_board *board, const struct hvp_segment *segment,
		   struct vm_area_struct *area);

/* hvp_chrdev.c */
int hvp_chrdev_add(struct hvp_board *board);
void hvp_chrdev_remove(struct hvp_board *board);

/* hvp_sysfs.c */
extern const struct attribute_group *hvp_groups[];

#endif
