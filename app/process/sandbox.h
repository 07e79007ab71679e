#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "app/process/progress.h"

namespace hvp::app {

struct SandboxLimits {
  int cpu_seconds = 60;
  // The address space; it is not enforced under AddressSanitizer, which reserves terabytes.
  std::size_t memory_bytes = std::size_t{4} << 30;
};

// Runs `work` in a forked child process and returns the bytes it returns. What the child prints
// is dropped; what it reports as progress arrives here. An InputError thrown in the child is
// thrown here with its key and message. A child that ends in any other way (a crash, exit, an
// uncaught exception, a limit) ends in an InputError with `key` that names `task`.
//
// Foreign code that reads files of users runs in here: it may crash, print and allocate as it
// likes. Call it before there are threads, since only the calling one lives on in the child.
std::string run_in_sandbox(std::string_view task, const std::string& key,
                           const SandboxLimits& limits, const Progress& progress,
                           const std::function<std::string(const Progress&)>& work);

}  // namespace hvp::app
