// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * For tests: takes the first board's driver through the recovery from a fatal error of the link, as
 * a port's driver does (Documentation/PCI/pci-error-recovery.rst): the error, a reset that leaves
 * nothing of the configuration space, the driver's answer to it, and its return to work. The reset
 * is the way through D3hot. Loading fails where the driver gives up or the BAR is not back.
 */
#include <linux/delay.h>
#include <linux/module.h>
#include <linux/pci.h>

#include "driver/hvp_pci.h"

static void reset_link(struct pci_dev *function)
{
	u16 state;

	pci_read_config_word(function, function->pm_cap + PCI_PM_CTRL, &state);
	pci_write_config_word(function, function->pm_cap + PCI_PM_CTRL,
			      state | (__force u16)PCI_D3hot);
	msleep(20);
	pci_write_config_word(function, function->pm_cap + PCI_PM_CTRL,
			      state & ~PCI_PM_CTRL_STATE_MASK);
	msleep(20);
}

static int recover(struct pci_dev *function)
{
	const struct pci_error_handlers *handlers;
	u16 before, after;

	if (!function->driver || !function->driver->err_handler)
		return -ENODEV;
	handlers = function->driver->err_handler;
	pci_read_config_word(function, PCI_COMMAND, &before);
	if (handlers->error_detected(function, pci_channel_io_frozen) != PCI_ERS_RESULT_NEED_RESET)
		return -EPROTO;
	reset_link(function);
	if (handlers->slot_reset(function) != PCI_ERS_RESULT_RECOVERED)
		return -EIO;
	handlers->resume(function);
	pci_read_config_word(function, PCI_COMMAND, &after);
	pci_info(function, "COMMAND %#06x before the error, %#06x after\n", before, after);
	return before == after ? 0 : -ENXIO;
}

static int __init recovery_init(void)
{
	struct pci_dev *function = pci_get_device(HVP_PCI_VENDOR_ID, HVP_PCI_DEVICE_ID, NULL);
	int ret;

	if (!function)
		return -ENODEV;
	device_lock(&function->dev);
	ret = recover(function);
	device_unlock(&function->dev);
	pci_dev_put(function);
	return ret;
}

static void __exit recovery_exit(void)
{
}

module_init(recovery_init);
module_exit(recovery_exit);

MODULE_AUTHOR("The hvp authors");
MODULE_DESCRIPTION("Takes the board's driver through a link's recovery");
MODULE_LICENSE("GPL");
