// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * For tests: maps memory for the first board in every way that the DMA API has, hands it over, and
 * unmaps it, by the rules. Loading fails where a mapping does. The board is not told of any of it.
 */
#include <linux/dma-mapping.h>
#include <linux/module.h>
#include <linux/pci.h>
#include <linux/scatterlist.h>
#include <linux/slab.h>

#include "driver/hvp_pci.h"

#define PARTS 3

static int map_coherent(struct device *dev)
{
	dma_addr_t address;
	struct page *pages;
	void *memory;

	memory = dma_alloc_coherent(dev, 3 * PAGE_SIZE, &address, GFP_KERNEL);
	if (!memory)
		return -ENOMEM;
	dma_free_coherent(dev, 3 * PAGE_SIZE, memory, address);

	pages = dma_alloc_pages(dev, PAGE_SIZE, &address, DMA_TO_DEVICE, GFP_KERNEL);
	if (!pages)
		return -ENOMEM;
	dma_sync_single_for_device(dev, address, PAGE_SIZE, DMA_TO_DEVICE);
	dma_free_pages(dev, PAGE_SIZE, pages, address, DMA_TO_DEVICE);
	return 0;
}

/* Twice the same memory, of which a part goes back and forth. */
static int map_single(struct device *dev, void *memory, enum dma_data_direction direction)
{
	const dma_addr_t first = dma_map_single(dev, memory, PAGE_SIZE, direction);
	const dma_addr_t second = dma_map_single(dev, memory + 64, 256, direction);

	if (dma_mapping_error(dev, first) || dma_mapping_error(dev, second))
		return -EIO;
	dma_sync_single_range_for_cpu(dev, first, 128, 64, direction);
	dma_sync_single_range_for_device(dev, first, 128, 64, direction);
	dma_unmap_single(dev, first, PAGE_SIZE, direction);
	dma_sync_single_for_cpu(dev, second, 256, direction);
	dma_unmap_single(dev, second, 256, direction);
	return 0;
}

static int map_list(struct device *dev, void *memory)
{
	struct scatterlist list[PARTS];
	int i, count;

	sg_init_table(list, PARTS);
	for (i = 0; i < PARTS; i++)
		sg_set_buf(&list[i], memory + i * 1024, 256 * (i + 1));
	count = dma_map_sg(dev, list, PARTS, DMA_FROM_DEVICE);
	if (!count)
		return -EIO;
	dma_sync_sg_for_cpu(dev, list, PARTS, DMA_FROM_DEVICE);
	dma_sync_sg_for_device(dev, list, PARTS, DMA_FROM_DEVICE);
	dma_unmap_sg(dev, list, PARTS, DMA_FROM_DEVICE);
	return 0;
}

static int map_all(struct device *dev)
{
	void *memory = (void *)get_zeroed_page(GFP_KERNEL);
	int ret;

	if (!memory)
		return -ENOMEM;
	ret = map_coherent(dev);
	if (!ret)
		ret = map_single(dev, memory, DMA_TO_DEVICE);
	if (!ret)
		ret = map_single(dev, memory, DMA_BIDIRECTIONAL);
	if (!ret)
		ret = map_list(dev, memory);
	free_page((unsigned long)memory);
	return ret;
}

static int __init mappings_init(void)
{
	struct pci_dev *function = pci_get_device(HVP_PCI_VENDOR_ID, HVP_PCI_DEVICE_ID, NULL);
	int ret;

	if (!function)
		return -ENODEV;
	ret = map_all(&function->dev);
	pci_dev_put(function);
	return ret;
}

static void __exit mappings_exit(void)
{
}

module_init(mappings_init);
module_exit(mappings_exit);

MODULE_AUTHOR("The hvp authors");
MODULE_DESCRIPTION("Maps memory for the board in every way");
MODULE_LICENSE("GPL");
