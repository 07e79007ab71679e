#pragma once

// Ctrl-C (SIGINT), the end of a terminal (SIGHUP) and the polite request to end (SIGTERM).
namespace hvp::results {

// From here on such a signal removes the files that are being written and ends the program, as
// without this call: the shell sees which signal it was. One that the program's parent had ignored
// stays ignored.
void end_cleanly_when_interrupted();

// While one is there, the first signal is only noted, and whoever works comes to an end that leaves
// what was done; the second one ends the program at once.
class DeferredInterruption {
 public:
  DeferredInterruption();
  ~DeferredInterruption();
  DeferredInterruption(const DeferredInterruption&) = delete;
  DeferredInterruption& operator=(const DeferredInterruption&) = delete;
};

// The signal that was noted; 0 without one.
int interrupted();

// Ends the program as the signal that was noted would have. Whatever is still to be written has to
// be flushed before.
[[noreturn]] void end_as_interrupted();

}  // namespace hvp::results
