// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * For tests: /dev/hvp-registers, the first board's BAR as a file of 32-bit words, beside the
 * driver, which knows nothing of it. Whoever writes there breaks what the driver has made.
 */
#include <linux/fs.h>
#include <linux/io.h>
#include <linux/miscdevice.h>
#include <linux/module.h>
#include <linux/pci.h>
#include <linux/uaccess.h>

#include "driver/hvp_pci.h"

static struct pci_dev *function;
static void __iomem *bar;

static bool is_word(size_t count, loff_t offset)
{
	return count == sizeof(u32) && offset % sizeof(u32) == 0 &&
	       offset < pci_resource_len(function, HVP_PCI_BAR);
}

static ssize_t registers_read(struct file *file, char __user *to, size_t count, loff_t *offset)
{
	u32 value;

	if (!is_word(count, *offset))
		return -EINVAL;
	value = ioread32(bar + *offset);
	return copy_to_user(to, &value, sizeof(value)) ? -EFAULT : (ssize_t)sizeof(value);
}

static ssize_t registers_write(struct file *file, const char __user *from, size_t count,
			       loff_t *offset)
{
	u32 value;

	if (!is_word(count, *offset))
		return -EINVAL;
	if (copy_from_user(&value, from, sizeof(value)))
		return -EFAULT;
	iowrite32(value, bar + *offset);
	return sizeof(value);
}

static const struct file_operations operations = {
	.owner = THIS_MODULE,
	.read = registers_read,
	.write = registers_write,
};

static struct miscdevice device = {
	.minor = MISC_DYNAMIC_MINOR,
	.name = "hvp-registers",
	.fops = &operations,
	.mode = 0600,
};

static int __init registers_init(void)
{
	int error;

	function = pci_get_device(HVP_PCI_VENDOR_ID, HVP_PCI_DEVICE_ID, NULL);
	if (!function)
		return -ENODEV;
	bar = pci_ioremap_bar(function, HVP_PCI_BAR);
	error = bar ? misc_register(&device) : -ENOMEM;
	if (error) {
		if (bar)
			iounmap(bar);
		pci_dev_put(function);
	}
	return error;
}

static void __exit registers_exit(void)
{
	misc_deregister(&device);
	iounmap(bar);
	pci_dev_put(function);
}

module_init(registers_init);
module_exit(registers_exit);
MODULE_DESCRIPTION("Registers of an HVP solver board, for tests of its driver");
MODULE_LICENSE("GPL");
