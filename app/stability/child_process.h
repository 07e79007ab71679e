#pragma once

#include <functional>
#include <string>

namespace hvp::app {

// What `work` returns, made in a process of its own: SystemC elaborates once in a process, and a
// search runs the platform many times. What it throws is thrown here again, an InputError with its
// key. Throws std::runtime_error where the process could not be started or was killed. The caller
// has no threads.
std::string in_child(const std::function<std::string()>& work);

}  // namespace hvp::app
