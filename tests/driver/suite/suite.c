#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tests/driver/suite/case.h"

static const struct case_entry* const groups[] = {setup_cases, solve_cases,    wait_cases,
                                                  error_cases, transfer_cases, fault_cases};
enum { GROUPS = sizeof groups / sizeof groups[0] };

void case_end(struct suite_case* c, enum case_result result, const char* format, ...) {
  va_list values;
  va_start(values, format);
  (void)vsnprintf(c->reason, sizeof c->reason, format, values);
  va_end(values);
  c->result = result;
}

bool case_status(struct suite_case* c, const char* call, int line, hvp_status found,
                 hvp_status expected) {
  if (found == expected) return true;
  case_end(c, CASE_FAILED, "line %d: %s returned %s, expected %s", line, call,
           hvp_status_name(found), hvp_status_name(expected));
  return false;
}

static void print_text(const char* text) {
  for (; *text != '\0'; ++text) {
    if (*text == '"' || *text == '\\') (void)putchar('\\');
    if ((unsigned char)*text >= 0x20U) (void)putchar(*text);
  }
}

static void print(const char* name, const struct suite_case* c) {
  static const char* const results[] = {"pass", "fail", "skip"};
  printf("{\"case\": \"%s\", \"result\": \"%s\"", name, results[c->result]);
  if (c->result != CASE_PASSED) {
    printf(", \"reason\": \"");
    print_text(c->reason);
    printf("\"");
  } else if (c->words != 0U) {
    printf(", \"u\": \"%08x\"", c->words);
  }
  printf("}\n");
  // A case that takes its process with it is the one after the last line.
  (void)fflush(stdout);
}

static bool run(const struct suite_board* board, const struct case_entry* entry) {
  struct suite_case c = {.board = board, .result = CASE_PASSED};
  const hvp_status opened = board->open(board->context, &c.client);
  if (case_status(&c, "open", __LINE__, opened, HVP_OK)) {
    entry->run(&c);
    const hvp_status closed = hvp_client_close(c.client);
    if (c.result == CASE_PASSED) (void)case_status(&c, "close", __LINE__, closed, HVP_OK);
  }
  print(entry->name, &c);
  return c.result != CASE_FAILED;
}

int suite_run(const struct suite_board* board, const char* only) {
  int failed = 0;
  bool found = only == NULL;
  for (int g = 0; g < GROUPS; ++g) {
    for (const struct case_entry* entry = groups[g]; entry->name != NULL; ++entry) {
      if (only != NULL && strcmp(only, entry->name) != 0) continue;
      found = true;
      if (!run(board, entry)) ++failed;
    }
  }
  return found ? failed : -1;
}

void suite_list(void) {
  for (int g = 0; g < GROUPS; ++g) {
    for (const struct case_entry* entry = groups[g]; entry->name != NULL; ++entry) {
      printf("%s\n", entry->name);
    }
  }
}

static int usage(const char* wrong) {
  (void)fprintf(stderr, "%s: expected [--case NAME] [--fault KIND] [--list]\n", wrong);
  return 2;
}

int suite_main(struct suite_board* board, int argc, char** argv) {
  const char* only = NULL;
  for (int i = 0; i < argc; ++i) {
    if (strcmp(argv[i], "--list") == 0) {
      suite_list();
      return 0;
    }
    const char** value = NULL;
    if (strcmp(argv[i], "--case") == 0) value = &only;
    if (strcmp(argv[i], "--fault") == 0) value = &board->fault;
    if (value == NULL || i + 1 == argc) return usage(argv[i]);
    *value = argv[++i];
  }
  // The other cases are about a board without faults.
  char fault_case[64];
  if (only == NULL && board->fault != NULL) {
    (void)snprintf(fault_case, sizeof fault_case, "fault-%s", board->fault);
    only = fault_case;
  }
  const int failed = suite_run(board, only);
  if (failed < 0) {
    (void)fprintf(stderr, "%s: no such case, --list names them\n", only);
    return 2;
  }
  return failed == 0 ? 0 : 1;
}
