// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * The solver board as a function on a PCI bus: found, taken into use and let go.
 */
#include <linux/dma-mapping.h>
#include <linux/interrupt.h>
#include <linux/io.h>
#include <linux/mm.h>
#include <linux/module.h>
#include <linux/slab.h>

#include "driver/generated/hvp_registers.h"
#include "driver/hvp_errno.h"
#include "driver/hvp_pci.h"

#include "hvp_module.h"

static bool dma = true;
module_param(dma, bool, 0444);
MODULE_PARM_DESC(dma, "b and U by the board's DMA engine, where it has one (default: on)");

static bool msi = true;
module_param(msi, bool, 0444);
MODULE_PARM_DESC(msi, "the interrupt as a message, where the board has them (default: on)");

static bool bus_errors;
module_param(bus_errors, bool, 0444);
MODULE_PARM_DESC(bus_errors, "look for errors of the bus around each job (default: off)");

#define LONGEST_WAIT_MS 60000
static unsigned int timeout_ms = 5000;

static int set_timeout(const char *value, const struct kernel_param *parameter)
{
	return param_set_uint_minmax(value, parameter, 1, LONGEST_WAIT_MS);
}

static const struct kernel_param_ops timeout_ops = {
	.set = set_timeout,
	.get = param_get_uint,
};
module_param_cb(timeout_ms, &timeout_ops, &timeout_ms, 0644);
MODULE_PARM_DESC(timeout_ms, "longest that a call waits for a job, 1 to 60000 (default: 5000)");

/**
 * hvp_longest_wait_ms() - the module's parameter timeout_ms
 *
 * Return: milliseconds; another value the next time, where someone has written to the parameter.
 */
unsigned int hvp_longest_wait_ms(void)
{
	return READ_ONCE(timeout_ms);
}

/**
 * hvp_board_get() - keep the board's memory, whatever becomes of the function
 * @board: one that is there
 */
void hvp_board_get(struct hvp_board *board)
{
	kref_get(&board->references);
}

static void free_board(struct kref *references)
{
	struct hvp_board *board = container_of(references, struct hvp_board, references);

	kvfree(board->vector);
	kfree(board->scratch);
	mutex_destroy(&board->map_mutex);
	mutex_destroy(&board->mutex);
	mutex_destroy(&board->calls);
	kfree(board);
}

/**
 * hvp_board_put() - the opposite of hvp_board_get()
 * @board: not to be used any more
 */
void hvp_board_put(struct hvp_board *board)
{
	kref_put(&board->references, free_board);
}

static void put_board(void *board)
{
	hvp_board_put(board);
}

static struct hvp_board *new_board(struct pci_dev *function)
{
	struct hvp_board *board = kzalloc(sizeof(*board), GFP_KERNEL);

	if (!board)
		return NULL;
	kref_init(&board->references);
	mutex_init(&board->calls);
	mutex_init(&board->mutex);
	mutex_init(&board->map_mutex);
	spin_lock_init(&board->line_lock);
	init_waitqueue_head(&board->wait);
	board->function = function;
	board->irq = -ENXIO;
	/* As long as the longest block of a frame: b, or U, of the largest matrix is one burst. */
	board->scratch = kmalloc(sizeof(hvp__U_t), GFP_KERNEL);
	if (!board->scratch) {
		hvp_board_put(board);
		return NULL;
	}
	return board;
}

/* A message if the board has them and the user wants them, else a line, else none. */
static void choose_interrupt(struct hvp_board *board)
{
	struct pci_dev *function = board->function;

	if (msi && pci_alloc_irq_vectors(function, 1, 1, PCI_IRQ_MSIX | PCI_IRQ_MSI) == 1)
		board->by_message = true;
	else if (pci_alloc_irq_vectors(function, 1, 1, PCI_IRQ_INTX) != 1)
		return;
	board->irq = pci_irq_vector(function, 0);
}

static int open_device(struct hvp_board *board)
{
	const struct hvp_bus bus = hvp_bar_bus(board, bus_errors);
	hvp_status status;

	/* The core has the board raise its line, which nobody would take down. */
	if (board->irq < 0)
		pci_intx(board->function, 0);
	mutex_lock(&board->mutex);
	status = hvp_open(&board->device, &bus, board->scratch, sizeof(hvp__U_t) / sizeof(u32));
	mutex_unlock(&board->mutex);
	if (status != HVP_OK)
		dev_err(&board->function->dev, "%s\n", hvp_status_text(status));
	return -hvp_errno_of(status);
}

/*
 * Behind hvp_open(), which the handler must not meet, and which has reset the board: nothing is up
 * before a job is started. What cannot be had is done without.
 */
static int request_interrupt(struct hvp_board *board)
{
	struct device *dev = &board->function->dev;
	int ret;

	if (board->irq < 0)
		return 0;
	ret = devm_request_irq(dev, board->irq, hvp_bar_interrupt,
			       board->by_message ? 0 : IRQF_SHARED, KBUILD_MODNAME, board);
	if (!ret)
		return 0;
	dev_warn(dev, "interrupt %d cannot be had (%d): polling\n", board->irq, ret);
	board->irq = ret;
	board->by_message = false;
	return open_device(board);
}

static int make_vector(struct hvp_board *board)
{
	board->vector_bytes = board->device.capability.max_nodes * 3 * sizeof(*board->vector);
	board->vector = kvmalloc(board->vector_bytes, GFP_KERNEL);
	return board->vector ? 0 : -ENOMEM;
}

/* A board without an engine works by blocks, and so does one for which there is no memory. */
static int start_engine(struct hvp_board *board)
{
	hvp_status status;
	u32 descriptors;
	int ret;

	if (!dma)
		return 0;
	mutex_lock(&board->mutex);
	descriptors = hvp_dma_descriptors(&board->device);
	mutex_unlock(&board->mutex);
	if (descriptors < HVP_ENGINE_DESCRIPTORS)
		return 0;
	ret = hvp_engine_make(board);
	if (ret) {
		dev_warn(&board->function->dev, "no memory for DMA (%d): by blocks\n", ret);
		return 0;
	}
	mutex_lock(&board->mutex);
	status = hvp_engine_use(board);
	mutex_unlock(&board->mutex);
	return -hvp_errno_of(status);
}

static int hvp_probe(struct pci_dev *function, const struct pci_device_id *id)
{
	struct device *dev = &function->dev;
	struct hvp_board *board;
	int ret;

	board = new_board(function);
	if (!board)
		return -ENOMEM;
	/* The first to be added is the last to go: the handler and the mappings are before it. */
	ret = devm_add_action_or_reset(dev, put_board, board);
	if (ret)
		return ret;
	ret = pcim_enable_device(function);
	if (ret)
		return dev_err_probe(dev, ret, "cannot be enabled\n");
	if (pci_resource_len(function, HVP_PCI_BAR) < sizeof(hvp_t))
		return dev_err_probe(dev, -ENODEV, "BAR %d is too small\n", HVP_PCI_BAR);
	ret = pcim_iomap_regions(function, BIT(HVP_PCI_BAR), KBUILD_MODNAME);
	if (ret)
		return dev_err_probe(dev, ret, "BAR %d cannot be mapped\n", HVP_PCI_BAR);
	board->bar = pcim_iomap_table(function)[HVP_PCI_BAR];
	if (dma_set_mask_and_coherent(dev, DMA_BIT_MASK(64)) &&
	    dma_set_mask_and_coherent(dev, DMA_BIT_MASK(32)))
		return dev_err_probe(dev, -EIO, "no address for DMA\n");
	choose_interrupt(board);
	ret = open_device(board);
	if (!ret)
		ret = request_interrupt(board);
	if (ret)
		return ret;
	/* Messages are writes of the board's own, as its DMA is. */
	pci_set_master(function);
	ret = make_vector(board);
	if (!ret)
		ret = start_engine(board);
	if (ret)
		return ret;
	pci_set_drvdata(function, board);
	/* For hvp_slot_reset(): a reset of the link leaves nothing of it. */
	pci_save_state(function);
	ret = hvp_chrdev_add(board);
	if (ret)
		return dev_err_probe(dev, ret, "no device file\n");
	dev_info(dev, "%s: %u nodes, %u blocks, %u kHz, %s, %s\n", board->name,
		 board->device.capability.max_nodes, board->device.capability.max_blocks,
		 board->device.capability.clock_khz, board->engine.usable ? "by DMA" : "by blocks",
		 hvp_interrupt_name(board));
	return 0;
}

/* A running job is aborted, so that the engine writes to no memory that is someone else's. */
static void quiesce(struct hvp_board *board)
{
	(void)hvp_reset(&board->device);
	(void)hvp_close(&board->device);
	clear_bit(HVP_BOARD_RUNNING, &board->flags);
}

static void hvp_remove(struct pci_dev *function)
{
	struct hvp_board *board = pci_get_drvdata(function);

	hvp_chrdev_remove(board);
	hvp_board_take_away(board, HVP_BOARD_GONE);
	quiesce(board);
	mutex_unlock(&board->mutex);
	/* Who is mapping the engine's memory has done so; nobody begins any more. */
	mutex_lock(&board->map_mutex);
	mutex_unlock(&board->map_mutex);
	pci_clear_master(function);
}

static void hvp_shutdown(struct pci_dev *function)
{
	struct hvp_board *board = pci_get_drvdata(function);

	hvp_board_take_away(board, HVP_BOARD_GONE);
	quiesce(board);
	mutex_unlock(&board->mutex);
	pci_clear_master(function);
}

static const struct pci_device_id hvp_ids[] = {
	{PCI_DEVICE(HVP_PCI_VENDOR_ID, HVP_PCI_DEVICE_ID)},
	{},
};
MODULE_DEVICE_TABLE(pci, hvp_ids);

static struct pci_driver hvp_driver = {
	.name = KBUILD_MODNAME,
	.id_table = hvp_ids,
	.probe = hvp_probe,
	.remove = hvp_remove,
	.shutdown = hvp_shutdown,
	.err_handler = &hvp_error_handlers,
	.driver.pm = pm_sleep_ptr(&hvp_pm_ops),
	.dev_groups = hvp_groups,
};
module_pci_driver(hvp_driver);

MODULE_AUTHOR("The hvp authors");
MODULE_DESCRIPTION("Solver board for haptic rendering");
MODULE_LICENSE("GPL");
