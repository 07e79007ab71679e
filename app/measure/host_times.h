#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "app/scene/scene.h"
#include "models/fit/processor_fit.h"
#include "models/host/processor.h"

namespace hvp::app {

// The caches of the machine that runs, as Linux tells them, with the built-in rates of a
// core of today to begin a search.
host::Processor caches_of_this_machine();

// The processor's name as /proc/cpuinfo has it, in one line; empty where there is none.
std::string processor_name();

// Times every solver of models/host on bodies of five sizes, of which the second and the fourth are
// held out: the lower quartile of repeated solves, caches warm. Tells what it is at.
std::vector<fit::SolveTime> time_solves(const Progress& progress);

// How late a process wakes after the ticks of a clock of 500 Hz while every core is busy: how often
// each latency was seen, in tenths of a microsecond.
struct WakeUps {
  std::map<std::int64_t, std::int64_t> counts;
  std::int64_t ticks = 0;
  bool real_time = false;  // the process had a real-time priority

  double longest_s() const;
  std::string csv() const;
};
WakeUps time_wake_ups(double seconds, const Progress& progress);

}  // namespace hvp::app
