#include <string.h>

#include "driver/generated/hvp_registers.h"
#include "tests/driver/suite/case.h"

// b, U and values by the board's DMA engine, and how the board interrupts.

bool case_use_dma(struct suite_case* c) {
  if (hvp_client_info_of(c->client)->dma) return true;
  const struct hvp_dma* dma = c->board->dma == NULL ? NULL : c->board->dma(c->board->context);
  if (dma == NULL) {
    case_end(c, CASE_SKIPPED, "no memory that the board reaches");
    return false;
  }
  const hvp_status status = hvp_client_use_dma(c->client, dma);
  if (status == HVP_ERROR_CAPABILITY) {
    case_end(c, CASE_SKIPPED, "the board has no DMA engine");
    return false;
  }
  return case_status(c, "use_dma", __LINE__, status, HVP_OK);
}

static void by_dma(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_result result;
  problem_make(&p);
  if (!case_use_dma(c) || !case_load(c, &p)) return;
  for (int job = 0; job < 3; ++job) {
    if (!case_solve(c, &p, u)) return;
  }
  EXPECT_OK(c, hvp_client_read_result(c->client, &result));
  EXPECT(c, result.job == 3U);
  // Held, by registers in between.
  problem_constrain(&p, 3U, 1000);
  EXPECT_OK(c, hvp_client_constrain_node(c->client, 3U, 1000));
  (void)case_solve(c, &p, u);
}

// Where the registers can be seen, they say that the engine has fetched them.
static void values_by_dma(struct suite_case* c) {
  if (!case_use_dma(c)) return;
  case_update_values(c);
  if (c->result != CASE_PASSED || c->board->peek == NULL) return;
  const uint32_t list =
      c->board->peek(c->board->context, (uint32_t)offsetof(hvp_t, DMA_VALUES_COUNT));
  EXPECT(c, list == 1U);
}

static void dma_and_blocks_agree(struct suite_case* c) {
  struct problem p;
  int32_t by_blocks[UNKNOWNS];
  int32_t u[UNKNOWNS];
  problem_make(&p);
  if (hvp_client_info_of(c->client)->dma) SKIP(c, "by DMA in any case");
  if (!case_load(c, &p) || !case_solve(c, &p, by_blocks)) return;
  if (!case_use_dma(c) || !case_load(c, &p) || !case_solve(c, &p, u)) return;
  EXPECT(c, memcmp(u, by_blocks, sizeof u) == 0);
  EXPECT_OK(c, hvp_client_use_dma(c->client, NULL));
  if (!case_solve(c, &p, u)) return;
  EXPECT(c, memcmp(u, by_blocks, sizeof u) == 0);
}

static void mapped(struct suite_case* c) {
  struct problem p;
  int32_t copied[UNKNOWNS];
  struct hvp_client_memory memory;
  problem_make(&p);
  if (!case_use_dma(c)) return;
  const hvp_status status = hvp_client_map(c->client, &memory);
  if (status == HVP_ERROR_CAPABILITY) SKIP(c, "b and U lie in several pieces");
  EXPECT_STATUS(c, status, HVP_OK);
  EXPECT(c, memory.rhs_bytes >= 2U * UNKNOWNS && memory.solution_bytes >= 2U * UNKNOWNS);
  if (!case_load(c, &p) || !case_solve(c, &p, copied)) return;
  memset(memory.rhs, 0, 2U * UNKNOWNS);
  unsigned char* bytes = (unsigned char*)memory.rhs;
  for (int i = 0; i < UNKNOWNS; ++i) {
    bytes[2 * i] = (unsigned char)((uint32_t)p.b[i] & 0xffU);
    bytes[2 * i + 1] = (unsigned char)((uint32_t)p.b[i] >> 8U & 0xffU);
  }
  EXPECT_OK(c, hvp_client_start(c->client));
  EXPECT_OK(c, hvp_client_wait(c->client, LONG_NS));
  const unsigned char* solved = (const unsigned char*)memory.solution;
  for (int i = 0; i < UNKNOWNS; ++i) {
    const int32_t word = solved[2 * i] | solved[2 * i + 1] << 8;
    EXPECT(c, (word ^ 0x8000) - 0x8000 == copied[i]);
  }
}

// Memory that the driver owns is another program's next.
static void next_program_finds_nothing(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_client_memory memory;
  problem_make(&p);
  if (!case_use_dma(c)) return;
  if (hvp_client_descriptor(c->client) < 0) SKIP(c, "b and U lie in the program's own memory");
  if (!case_load(c, &p) || !case_solve(c, &p, u)) return;
  EXPECT_OK(c, hvp_client_close(c->client));
  c->client = NULL;
  EXPECT_OK(c, c->board->open(c->board->context, &c->client));
  EXPECT_OK(c, hvp_client_map(c->client, &memory));
  const unsigned char* rhs = (const unsigned char*)memory.rhs;
  const unsigned char* solution = (const unsigned char*)memory.solution;
  for (size_t i = 0; i < memory.rhs_bytes; ++i) EXPECT(c, rhs[i] == 0U);
  for (size_t i = 0; i < memory.solution_bytes; ++i) EXPECT(c, solution[i] == 0U);
}

static void dma_from_elsewhere(struct suite_case* c, uint32_t offset, uint32_t value,
                               hvp_status expected, uint32_t detail) {
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  if (c->board->poke == NULL) SKIP(c, "no way to the registers beside the driver");
  if (!case_use_dma(c) || !case_load(c, &p)) return;
  c->board->poke(c->board->context, offset, value);
  EXPECT_OK(c, hvp_client_start(c->client));
  EXPECT_STATUS(c, hvp_client_wait(c->client, LONG_NS), expected);
  EXPECT(c, hvp_client_error_detail(c->client) == detail);
  // A new matrix tells the board of its list again.
  if (!case_load(c, &p)) return;
  (void)case_solve(c, &p, u);
}

#define AT(name) ((uint32_t)offsetof(hvp_t, name))

static void dma_without_an_answer(struct suite_case* c) {
  dma_from_elsewhere(c, AT(DMA_LIST_HIGH), 0x7fffffffU, HVP_ERROR_DMA, 0xfffffffeU);
}

// No descriptor for b, where each board has to have one.
static void bad_descriptor(struct suite_case* c) {
  const struct hvp_dma* dma = c->board->dma == NULL ? NULL : c->board->dma(c->board->context);
  if (dma == NULL) SKIP(c, "no way to the list beside the driver");
  struct problem p;
  int32_t u[UNKNOWNS];
  problem_make(&p);
  if (!case_use_dma(c) || !case_load(c, &p)) return;
  // The first descriptor's bytes; no byte order makes them a multiple of four.
  dma->list[1] = 0x03030303U;
  EXPECT_OK(c, hvp_client_start(c->client));
  EXPECT_STATUS(c, hvp_client_wait(c->client, LONG_NS), HVP_ERROR_BAD_DESCRIPTOR);
  EXPECT(c, hvp_client_error_detail(c->client) == 0U);
  if (!case_load(c, &p)) return;
  (void)case_solve(c, &p, u);
}

static void messages(struct suite_case* c) {
  struct problem p;
  int32_t u[UNKNOWNS];
  struct hvp_statistics before;
  struct hvp_statistics after;
  problem_make(&p);
  const struct hvp_client_info* info = hvp_client_info_of(c->client);
  if (!info->interrupts) SKIP(c, "the driver polls");
  if (!info->messages) SKIP(c, "the board interrupts by a line");
  if (!case_load(c, &p)) return;
  EXPECT_OK(c, hvp_client_statistics(c->client, &before));
  for (int job = 0; job < 10; ++job) {
    if (!case_solve(c, &p, u)) return;
  }
  EXPECT_OK(c, hvp_client_statistics(c->client, &after));
  EXPECT(c, after.lost_interrupts == before.lost_interrupts);
}

const struct case_entry transfer_cases[] = {
    {"dma", by_dma},
    {"dma-update-values", values_by_dma},
    {"dma-and-blocks", dma_and_blocks_agree},
    {"dma-mapped", mapped},
    {"dma-next-program", next_program_finds_nothing},
    {"dma-without-an-answer", dma_without_an_answer},
    {"dma-bad-descriptor", bad_descriptor},
    {"messages", messages},
    {NULL, NULL},
};
