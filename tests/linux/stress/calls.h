#ifndef HVP_STRESS_CALLS_H
#define HVP_STRESS_CALLS_H

#include "tests/linux/stress/stress.h"

// One call each, judged and counted; HVP_STATUS_COUNT where the driver was not asked.

void stress_open(struct stress_worker* worker);
void stress_close(struct stress_worker* worker);
hvp_status stress_info(struct stress_worker* worker, struct hvp_ioc_info* info);
hvp_status stress_statistics(struct stress_worker* worker);
hvp_status stress_reset(struct stress_worker* worker);
hvp_status stress_configure(struct stress_worker* worker);
hvp_status stress_load(struct stress_worker* worker);
hvp_status stress_constrain(struct stress_worker* worker);
hvp_status stress_restore(struct stress_worker* worker);
hvp_status stress_write(struct stress_worker* worker, enum stress_operation operation,
                        unsigned rhs);
hvp_status stress_start(struct stress_worker* worker);
hvp_status stress_wait(struct stress_worker* worker, uint64_t timeout_ns);
// Whether there was something to be heard.
bool stress_poll(struct stress_worker* worker, int timeout_ms);
hvp_status stress_read_solution(struct stress_worker* worker, int32_t* u);
hvp_status stress_read_result(struct stress_worker* worker);
hvp_status stress_solve(struct stress_worker* worker, unsigned rhs, uint64_t timeout_ns,
                        int32_t* u);
// What no program should ask: it is refused, and nothing happens.
void stress_ask_wrongly(struct stress_worker* worker);
void stress_read_attribute(struct stress_worker* worker);
// NULL where it cannot be had. The program keeps the memory when the board is gone.
void* stress_map(struct stress_worker* worker, uint32_t which, size_t bytes);

#endif
