#pragma once

#include <functional>
#include <string>

namespace hvp::app {

// Runs `work` in a process of its own and returns its result. SystemC elaborates only once in a
// process, and a search runs the platform many times. An exception of `work` is rethrown here, an
// InputError with its key. Throws std::runtime_error if the process could not be started or was
// killed. The caller must not have threads.
std::string in_child(const std::function<std::string()>& work);

}  // namespace hvp::app
