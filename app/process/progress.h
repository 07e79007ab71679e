#pragma once

#include <functional>
#include <string_view>

namespace hvp::app {

// A function that gets one short line on what is being done; may be empty.
using Progress = std::function<void(std::string_view)>;

}  // namespace hvp::app
