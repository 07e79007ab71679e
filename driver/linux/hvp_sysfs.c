// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * What the board can do and what has become of its jobs, one value a file (docs/driver.md).
 */
#include <linux/device.h>
#include <linux/sysfs.h>

#include "hvp_module.h"

static const struct hvp_board *board_of(const struct device *dev)
{
	return dev_get_drvdata(dev);
}

static const struct hvp_capability *capability_of(const struct device *dev)
{
	return &board_of(dev)->device.capability;
}

static const struct hvp_statistics *statistics_of(const struct device *dev)
{
	return &board_of(dev)->device.statistics;
}

/*
 * None touches the board. What changes does so under the mutex, which a call holds for as long as
 * it waits; a single word may be read beside it.
 */
#define HVP_ATTRIBUTE(name, format, value)                                                 \
	static ssize_t name##_show(struct device *dev, struct device_attribute *attribute, \
				   char *text)                                             \
	{                                                                                  \
		return sysfs_emit(text, format "\n", READ_ONCE(value));    \
	}                                                                                  \
	static DEVICE_ATTR_RO(name)

HVP_ATTRIBUTE(max_nodes, "%u", capability_of(dev)->max_nodes);
HVP_ATTRIBUTE(max_row_blocks, "%u", capability_of(dev)->max_row_blocks);
HVP_ATTRIBUTE(max_blocks, "%u", capability_of(dev)->max_blocks);
HVP_ATTRIBUTE(max_matrix_bits, "%u", capability_of(dev)->max_matrix_bits);
HVP_ATTRIBUTE(max_vector_bits, "%u", capability_of(dev)->max_vector_bits);
HVP_ATTRIBUTE(max_rhs_bits, "%u", capability_of(dev)->max_rhs_bits);
HVP_ATTRIBUTE(max_coefficient_bits, "%u", capability_of(dev)->max_coefficient_bits);
HVP_ATTRIBUTE(max_scalar_bits, "%u", capability_of(dev)->max_scalar_bits);
HVP_ATTRIBUTE(clock_khz, "%u", capability_of(dev)->clock_khz);
HVP_ATTRIBUTE(methods, "0x%x", capability_of(dev)->methods);
HVP_ATTRIBUTE(start_modes, "0x%x", capability_of(dev)->start_modes);
HVP_ATTRIBUTE(dma, "%d", board_of(dev)->engine.usable);

static ssize_t interrupt_show(struct device *dev, struct device_attribute *attribute, char *text)
{
	return sysfs_emit(text, "%s\n", hvp_interrupt_name(board_of(dev)));
}
static DEVICE_ATTR_RO(interrupt);

static struct attribute *capability_attributes[] = {
	&dev_attr_max_nodes.attr,
	&dev_attr_max_row_blocks.attr,
	&dev_attr_max_blocks.attr,
	&dev_attr_max_matrix_bits.attr,
	&dev_attr_max_vector_bits.attr,
	&dev_attr_max_rhs_bits.attr,
	&dev_attr_max_coefficient_bits.attr,
	&dev_attr_max_scalar_bits.attr,
	&dev_attr_clock_khz.attr,
	&dev_attr_methods.attr,
	&dev_attr_start_modes.attr,
	&dev_attr_dma.attr,
	&dev_attr_interrupt.attr,
	NULL,
};

static const struct attribute_group capability_group = {
	.name = "capability",
	.attrs = capability_attributes,
};

HVP_ATTRIBUTE(jobs, "%llu", board_of(dev)->jobs);
HVP_ATTRIBUTE(lost_interrupts, "%u", statistics_of(dev)->lost_interrupts);
HVP_ATTRIBUTE(lost_acknowledgements, "%u", statistics_of(dev)->lost_acknowledgements);
HVP_ATTRIBUTE(last_error_detail, "0x%x", board_of(dev)->last_detail);

static ssize_t interrupts_show(struct device *dev, struct device_attribute *attribute, char *text)
{
	return sysfs_emit(text, "%u\n", (unsigned int)atomic_read(&board_of(dev)->interrupts));
}
static DEVICE_ATTR_RO(interrupts);

static ssize_t last_error_show(struct device *dev, struct device_attribute *attribute, char *text)
{
	return sysfs_emit(text, "%s\n", hvp_status_name(READ_ONCE(board_of(dev)->last_error)));
}
static DEVICE_ATTR_RO(last_error);

static struct attribute *statistics_attributes[] = {
	&dev_attr_jobs.attr,
	&dev_attr_interrupts.attr,
	&dev_attr_lost_interrupts.attr,
	&dev_attr_lost_acknowledgements.attr,
	&dev_attr_last_error.attr,
	&dev_attr_last_error_detail.attr,
	NULL,
};

static const struct attribute_group statistics_group = {
	.name = "statistics",
	.attrs = statistics_attributes,
};

/* The attributes of a board: made and taken away by the driver core, around the driver. */
const struct attribute_group *hvp_groups[] = {
	&capability_group,
	&statistics_group,
	NULL,
};
