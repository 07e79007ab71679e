// Called by the translated engines of covered.py (observed.sv). When the last engine of a process
// ends, the counts go to the file HVP_COUNTS and Verilator's of lines to HVP_LINES.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include <verilated.h>
#include <verilated_cov.h>

namespace {

std::map<std::pair<std::string, int>, long long> events;
// By pass, for what a package waits, rows that wait, how many have room, and whether the size has
// packages that take turns.
std::map<std::tuple<int, int, int, int, int>, long long> partitions;
int engines = 0;
int pass = -1;  // no engine has had a clock

}  // namespace

extern "C" {

void hvp_begins() { ++engines; }

void hvp_ends() {
  if (--engines > 0) return;
  Verilated::threadContextp()->coveragep()->write(std::getenv("HVP_LINES"));
  std::FILE* const file = std::fopen(std::getenv("HVP_COUNTS"), "w");
  if (file == nullptr) std::abort();
  for (const auto& [event, count] : events) {
    std::fprintf(file, "event\t%s\t%d\t%lld\n", event.first.c_str(), event.second, count);
  }
  for (const auto& [seen, count] : partitions) {
    const auto [of_pass, waits, rows, depth, turns] = seen;
    std::fprintf(file, "partition\t%d\t%d\t%d\t%d\t%d\t%lld\n", of_pass, waits, rows, depth, turns,
                 count);
  }
  std::fclose(file);
}

void hvp_event(const char* what, int number) { ++events[{what, number}]; }

void hvp_pass(int of_engine) { pass = of_engine; }

void hvp_partition(int waits, int rows, int depth, int turns) {
  if (pass >= 0) ++partitions[{pass, waits, rows, depth, turns}];
}
}
