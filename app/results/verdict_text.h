#pragma once

#include <string>
#include <string_view>

#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::results {

// What a budget that held is called. "PASS" alone is said of a run in which everything that the
// word covers was measured: without flags and faults, with numbers, with a contact, and beside a
// reference.
std::string_view verdict_word(const Outcome& outcome, bool timing_only);

// Lines under the verdict of a run whose probe did not touch the body: how near it came, how large
// both are, and whether that looks like a mistake in a unit.
std::string no_contact_text(const app::Scene& scene, const Outcome& outcome);

// A line that says so where body and probe are of sizes that look like another unit; else empty.
std::string unit_text(const app::Scene& scene);

}  // namespace hvp::results
