#pragma once

#include <filesystem>
#include <string>

#include "app/scene/scenario.h"

namespace hvp::results {

// The text of scenario.resolved.toml, without writing anything: the files that come along have the
// names that they would have there.
std::string resolved_text(const app::Scenario& scenario, const std::filesystem::path& device);

// scenario.resolved.toml: every parameter with the value it had, a scenario of its own that
// gives the same run again. A surface file comes along as scenario.resolved.stl (or its other
// extension) and a device of the user's own as scenario.resolved.device.toml, because a path would
// tie the results to a place. `device` is where that can be opened; empty for a built-in device.
// Throws std::runtime_error.
void write_resolved_scenario(const std::filesystem::path& directory, const app::Scenario& scenario,
                             const std::filesystem::path& device);

}  // namespace hvp::results
