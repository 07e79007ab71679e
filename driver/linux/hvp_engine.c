// SPDX-License-Identifier: GPL-2.0-only OR Apache-2.0
/*
 * Memory for the board's DMA engine.
 *
 * b and U are pages of the kernel's own under a streaming mapping that stays for as long as the
 * board does. A program may map those pages; each keeps its page alive, so that a board may be
 * taken away under it, which memory from dma_alloc_coherent() does not survive. And they are in the
 * cache, which is what the core wants where DMA is not coherent: it packs and unpacks a word at a
 * time.
 *
 * The list and the record are coherent: the list is written once a matrix, and the record is eight
 * words that are looked at while the board may still write them, where a cache line would only be
 * in the way.
 */
#include <linux/dma-mapping.h>
#include <linux/mm.h>
#include <linux/slab.h>

#include "hvp_module.h"

/* Each direction has one segment. */
#define LIST_WORDS   (HVP_ENGINE_DESCRIPTORS * HVP_DESCRIPTOR_WORDS)
#define VALUES_BYTES ((size_t)64 << 10) /* of a segment of values: pages in a row are few */
#define SHARED_BYTES ((LIST_WORDS + HVP_RECORD_WORDS) * sizeof(u32))

static void sync_segment(struct hvp_board *board, const struct hvp_segment *part,
			 enum dma_data_direction direction, hvp_owner owner)
{
	struct device *dev = &board->function->dev;

	/* A part lies within a mapping: the DMA layer takes any address of one. */
	if (owner == HVP_OWNER_PROCESSOR)
		dma_sync_single_for_cpu(dev, part->bus_address, part->bytes, direction);
	else
		dma_sync_single_for_device(dev, part->bus_address, part->bytes, direction);
}

static void engine_sync(void *context, hvp_area area, const struct hvp_segment *part,
			hvp_owner owner)
{
	switch (area) {
	case HVP_AREA_TO_BOARD:
	case HVP_AREA_VALUES:
		sync_segment(context, part, DMA_TO_DEVICE, owner);
		break;
	case HVP_AREA_TO_HOST:
		sync_segment(context, part, DMA_FROM_DEVICE, owner);
		break;
	case HVP_AREA_LIST:
	case HVP_AREA_RECORD:
		/* Coherent, but the processor may still reorder what it reads and writes. */
		if (owner == HVP_OWNER_PROCESSOR)
			dma_rmb();
		else
			dma_wmb();
		break;
	}
}

struct mapped_pages {
	struct hvp_board *board;
	struct hvp_segment *segment;
	enum dma_data_direction direction;
};

static void free_pages_of(void *context)
{
	const struct mapped_pages *pages = context;

	dma_unmap_single(&pages->board->function->dev, pages->segment->bus_address,
			 pages->segment->bytes, pages->direction);
	free_pages_exact(pages->segment->memory, pages->segment->bytes);
}

static int map_pages(struct hvp_board *board, struct hvp_segment *segment, size_t bytes,
		     enum dma_data_direction direction)
{
	struct device *dev = &board->function->dev;
	struct mapped_pages *pages;
	dma_addr_t address;

	pages = devm_kmalloc(dev, sizeof(*pages), GFP_KERNEL);
	if (!pages)
		return -ENOMEM;
	segment->memory = alloc_pages_exact(bytes, GFP_KERNEL | __GFP_ZERO);
	if (!segment->memory)
		return -ENOMEM;
	address = dma_map_single(dev, segment->memory, bytes, direction);
	if (dma_mapping_error(dev, address)) {
		free_pages_exact(segment->memory, bytes);
		return -ENOMEM;
	}
	segment->bus_address = address;
	segment->bytes = bytes;
	*pages = (struct mapped_pages){.board = board, .segment = segment, .direction = direction};
	return devm_add_action_or_reset(dev, free_pages_of, pages);
}

static void forget_segment(struct hvp_board *board, const struct hvp_segment *segment,
			   enum dma_data_direction direction)
{
	sync_segment(board, segment, direction, HVP_OWNER_PROCESSOR);
	memset(segment->memory, 0, segment->bytes);
	sync_segment(board, segment, direction, HVP_OWNER_DEVICE);
}

/**
 * hvp_engine_forget() - leave nothing of a program's b and U for the next one that maps them
 * @board: which has no job, and which no program has open
 */
void hvp_engine_forget(struct hvp_board *board)
{
	if (!board->engine.usable)
		return;
	forget_segment(board, &board->engine.to_board, DMA_TO_DEVICE);
	forget_segment(board, &board->engine.to_host, DMA_FROM_DEVICE);
}

/**
 * hvp_engine_make() - make and map the memory for the largest matrix that the board takes
 * @board: whose capability is known
 *
 * It goes with the function's driver, or at once where some of it cannot be had.
 *
 * Return: 0 or -ENOMEM.
 */
int hvp_engine_make(struct hvp_board *board)
{
	struct hvp_engine_memory *engine = &board->engine;
	struct device *dev = &board->function->dev;
	int ret;

	if (!devres_open_group(dev, engine, GFP_KERNEL))
		return -ENOMEM;
	engine->shared = dmam_alloc_coherent(dev, SHARED_BYTES, &engine->shared_address,
					     GFP_KERNEL);
	ret = engine->shared ? 0 : -ENOMEM;
	if (!ret)
		ret = map_pages(board, &engine->to_board, PAGE_ALIGN(board->vector_bytes),
				DMA_TO_DEVICE);
	if (!ret)
		ret = map_pages(board, &engine->to_host, PAGE_ALIGN(board->vector_bytes),
				DMA_FROM_DEVICE);
	if (ret)
		devres_release_group(dev, engine);
	else
		devres_close_group(dev, engine);
	engine->usable = !ret;
	return ret;
}

/**
 * hvp_engine_use() - have the engine move b, U and what there is memory for from now on
 * @board: between two jobs
 *
 * Return: what hvp_use_dma() says.
 */
hvp_status hvp_engine_use(struct hvp_board *board)
{
	const struct hvp_engine_memory *engine = &board->engine;
	const struct hvp_values_memory *values = engine->values;
	const struct hvp_dma dma = {
		.to_board = &engine->to_board,
		.to_board_count = 1,
		.to_host = &engine->to_host,
		.to_host_count = 1,
		.list = engine->shared,
		.list_address = engine->shared_address,
		.record = engine->shared + LIST_WORDS,
		.record_address = engine->shared_address + LIST_WORDS * sizeof(u32),
		.values = values ? values->segments : NULL,
		.values_count = values ? values->count : 0,
		.values_list = values ? values->list : NULL,
		.values_list_address = values ? values->list_address : 0,
		.context = board,
		.sync = engine_sync,
	};

	return hvp_use_dma(&board->device, &dma);
}

static int map_values(struct hvp_board *board, struct hvp_values_memory *values, size_t bytes)
{
	int ret = 0;

	while (!ret && values->bytes < bytes) {
		const size_t part = min_t(size_t, bytes - values->bytes, VALUES_BYTES);
		struct hvp_segment *segment = &values->segments[values->count];

		ret = map_pages(board, segment, PAGE_ALIGN(part), DMA_TO_DEVICE);
		if (ret)
			break;
		values->bytes += segment->bytes;
		values->count++;
	}
	return ret;
}

static struct hvp_values_memory *make_values(struct hvp_board *board, size_t bytes)
{
	struct device *dev = &board->function->dev;
	const size_t most = DIV_ROUND_UP(bytes, VALUES_BYTES);
	struct hvp_values_memory *values = NULL;
	void *group = devres_open_group(dev, NULL, GFP_KERNEL);

	if (!group)
		return NULL;
	values = devm_kzalloc(dev, struct_size(values, segments, most), GFP_KERNEL);
	if (!values)
		goto fail;
	values->group = group;
	values->list = dmam_alloc_coherent(dev, most * HVP_DESCRIPTOR_WORDS * sizeof(u32),
					   &values->list_address, GFP_KERNEL);
	if (!values->list || map_values(board, values, bytes))
		goto fail;
	devres_close_group(dev, group);
	return values;

fail:
	devres_release_group(dev, group);
	return NULL;
}

/**
 * hvp_engine_hold_values() - have memory from which the engine fetches the loaded matrix' values
 * @board: whose program is about to update them
 *
 * Few programs do, and the largest matrix has megabytes. Where they cannot be had, the values go by
 * blocks.
 */
void hvp_engine_hold_values(struct hvp_board *board)
{
	const size_t bytes = hvp_dma_values_bytes(&board->device);
	struct hvp_engine_memory *engine = &board->engine;
	struct hvp_values_memory *before = engine->values;
	struct hvp_values_memory *made;

	if (!bytes || (before && before->bytes >= bytes))
		return;
	made = make_values(board, bytes);
	if (!made)
		return;
	engine->values = made;
	if (hvp_engine_use(board) != HVP_OK) {
		engine->values = before;
		before = made;
	}
	if (before)
		devres_release_group(&board->function->dev, before->group);
}

/**
 * hvp_engine_give() - hand over what a program may have written to the pages of b
 * @board: whose job is about to start
 */
void hvp_engine_give(struct hvp_board *board)
{
	if (board->engine.mapped)
		sync_segment(board, &board->engine.to_board, DMA_TO_DEVICE, HVP_OWNER_DEVICE);
}

/**
 * hvp_engine_take() - let a program read from the pages of U
 * @board: whose job has ended
 */
void hvp_engine_take(struct hvp_board *board)
{
	if (board->engine.mapped)
		sync_segment(board, &board->engine.to_host, DMA_FROM_DEVICE, HVP_OWNER_PROCESSOR);
}

/**
 * hvp_engine_map() - show a segment's pages to a program
 * @board: that is there
 * @segment: one of @board's engine
 * @area: of the program's memory, from the segment's begin
 *
 * Return: 0, -EINVAL for more than the segment has, or what vm_insert_page() says.
 */
int hvp_engine_map(struct hvp_board *board, const struct hvp_segment *segment,
		   struct vm_area_struct *area)
{
	const size_t bytes = area->vm_end - area->vm_start;
	size_t at;

	if (bytes > segment->bytes)
		return -EINVAL;
	for (at = 0; at < bytes; at += PAGE_SIZE) {
		struct page *page = virt_to_page((u8 *)segment->memory + at);
		const int ret = vm_insert_page(area, area->vm_start + at, page);

		if (ret)
			return ret;
	}
	WRITE_ONCE(board->engine.mapped, true);
	return 0;
}
