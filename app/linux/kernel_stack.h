#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace hvp::guest {

// Where a User-Mode Linux is, as this machine sees its process: the function that its processor is
// in, then those whose return addresses are on its stack, the innermost first. Addresses that are
// left over from calls before may be among them, and functions of a module have no name here.
// Stops the process for a moment; empty where that is not allowed.
std::vector<std::string> kernel_stack(pid_t process, const std::filesystem::path& kernel);

// True if another process traces this one, as a debugger does.
bool is_traced(pid_t process);

}  // namespace hvp::guest
