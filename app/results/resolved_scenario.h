#pragma once

#include <filesystem>

#include "app/scene/scenario.h"

namespace hvp::results {

// scenario.resolved.toml: every parameter with the value it had, a scenario of its own that
// gives the same run again. A surface file comes along as scenario.resolved.stl (or its other
// extension), because a path would tie the results to a place. `surface` is where it can be
// opened; empty when the body is a sphere or a box. Throws std::runtime_error.
void write_resolved_scenario(const std::filesystem::path& directory, const app::Scenario& scenario,
                             const std::filesystem::path& surface);

}  // namespace hvp::results
