#ifndef HVP_STRESS_H
#define HVP_STRESS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include "driver/linux/hvp_ioctl.h"
#include "tests/driver/suite/case.h"

// A program that asks everything of a board's device file at once, in an order that a seed draws,
// while someone else takes the board away, resets it and sends it to sleep.

enum stress_operation {
  STRESS_OPEN,
  STRESS_CLOSE,
  STRESS_INFO,
  STRESS_STATISTICS,
  STRESS_RESET,
  STRESS_CONFIGURE,
  STRESS_LOAD,
  STRESS_CONSTRAIN,
  STRESS_RESTORE,
  STRESS_WRITE_RHS,
  STRESS_WRITE_GUESS,
  STRESS_START,
  STRESS_WAIT,
  STRESS_POLL,
  STRESS_READ_SOLUTION,
  STRESS_READ_RESULT,
  STRESS_SOLVE,
  STRESS_MAP,
  STRESS_WRONG,  // a call that no program should make
  STRESS_ATTRIBUTE,
  STRESS_OPERATIONS
};
const char* stress_operation_name(enum stress_operation operation);

// Every U that a successful job may have: each b with each of the matrices and counts of iterations
// that the program sends. The longer jobs take milliseconds, so that much befalls them.
enum {
  STRESS_RHS = 4,
  STRESS_MATRICES = 2,
  STRESS_LENGTHS = 2,
  STRESS_HELD_NODE = 5,
  STRESS_DIAGONAL = 1000
};
struct stress_references {
  struct problem problem;
  int32_t b[STRESS_RHS][UNKNOWNS];
  int32_t u[STRESS_LENGTHS][STRESS_MATRICES][STRESS_RHS][UNKNOWNS];
};
// Of the board itself, while nothing else goes on. False after a line that says what failed.
bool stress_make_references(struct stress_references* references, const char* board);
bool stress_is_solution(const struct stress_references* references, unsigned rhs, const int32_t* u);
struct hvp_solver_config stress_config(unsigned length);

enum { STRESS_WORKERS = 4, STRESS_MAPS = 2 };

struct stress;

struct stress_worker {
  struct stress* stress;
  unsigned number;
  pthread_t thread;
  uint64_t random;
  // What it is doing, for who watches over it; 0: nothing that may take long.
  _Atomic uint64_t since_ns;
  _Atomic int operation;
  void* maps[STRESS_MAPS];  // a page each, or none
};

struct stress {
  const char* board;
  const char* attributes;  // the function's folder in sysfs
  uint64_t end_ns;
  bool loses_power;        // the board may come back as after power-on, and nobody is told
  _Atomic int descriptor;  // -1: closed
  _Atomic bool failed;
  // Held for reading by who makes single calls, and for writing by who needs the board to itself.
  pthread_rwlock_t turns;
  struct stress_references references;
  struct stress_worker workers[STRESS_WORKERS];
};

uint64_t stress_now_ns(void);
// From 0 to below `limit`.
uint32_t stress_draw(struct stress_worker* worker, uint32_t limit);
// One thing after the other until the end, or a failure.
void* stress_work(void* worker);

// What the calls came to.
void stress_fail(struct stress* stress, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
void stress_begin(struct stress_worker* worker, enum stress_operation operation);
void stress_end(struct stress_worker* worker);
void stress_count(enum stress_operation operation, const char* outcome);
// After an ioctl: fails where the outcome is not one that the operation may have.
hvp_status stress_judge(struct stress_worker* worker, enum stress_operation operation,
                        const struct hvp_ioc_head* head, int outcome, int error, bool signalled);
// After another call: 0, or a number of errno among `allowed`, which ends with 0.
bool stress_judge_error(struct stress_worker* worker, enum stress_operation operation, int error,
                        const int* allowed);
// A line for each operation and outcome.
void stress_report(void);

// How often this thread's signal has come.
unsigned stress_signals(void);
void stress_take_signals(void);

#endif
