#pragma once

#include "app/scene/loaded_scenario.h"
#include "vp/platform_settings.h"

namespace hvp::app {

// What vp::BoardFunction is built from: a scenario's board and what is around it, for a host of
// another program. Nothing is meshed or assembled, as that host brings the system to be solved.
// Throws InputError, complete with file and line, where the scenario has no board ([wall], a host
// that solves) or something that only the host of `hvp run` gives: no words (`fidelity.numbers`),
// pictures on the bus.
vp::PlatformSettings outside_board(const LoadedScenario& loaded);

}  // namespace hvp::app
