#pragma once

#include <string>

namespace hvp::tables {

// docs/devices.md: what the built-in devices have, from their files, and how to add one.
std::string devices_page();

}  // namespace hvp::tables
