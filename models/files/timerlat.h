#pragma once

#include <string_view>

#include "models/files/latencies.h"

namespace hvp::files {

// True of the output of `rtla timerlat hist`, and of that of other histograms of rtla.
bool is_timerlat(std::string_view text);

// Reads what `rtla timerlat hist` prints: a line of names (Index, and for each processor IRQ-000,
// Thr-000 and, with -u, Usr-000), lines of a latency and its counts, and a summary of which `over:`
// and `max:` are taken. The latencies are those of the thread in user space where there are any,
// else those of the kernel's thread, of all processors together; the interrupt's are part of both.
// Throws InputError with the line that is to blame, and for another histogram than timerlat's.
Latencies read_timerlat(std::string_view text);

}  // namespace hvp::files
