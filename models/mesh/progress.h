#pragma once

#include <functional>
#include <string_view>

namespace hvp::mesh {

// Told in one short line what is being done; may be empty.
using Progress = std::function<void(std::string_view)>;

}  // namespace hvp::mesh
