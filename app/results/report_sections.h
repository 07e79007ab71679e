#pragma once

#include <string>

#include "app/results/outcome.h"
#include "app/scene/scene.h"

// The sections of the terminal's report that have a file of their own. Each ends with a line break;
// empty where there is nothing to say.
namespace hvp::results {

// A line that says so where body and probe are of sizes that look like another unit.
std::string unit_text(const app::Scene& scene);

// Lines under the verdict of a run whose probe did not touch the body: how near it came, how large
// both are, and whether that looks like a mistake in a unit.
std::string no_contact_text(const app::Scene& scene, const ContactFigures& contact);

// Time on the critical path by part.
std::string parts_text(const LatencyFigures& figures);

// How far the run was from double precision.
std::string accuracy_text(const app::Scene& scene, const Outcome& outcome);

// What the force is like, and how far the body was strained.
std::string force_text(const Outcome& outcome);

// What the closed loop is like, of each device with mass.
std::string loop_text(const Outcome& outcome);
// What latency costs in stiffness.
std::string stiffness_text(const std::optional<StiffnessBudget>& budget);

// What was injected, and what the driver had trouble with.
std::string fault_text(const Outcome& outcome);

}  // namespace hvp::results
