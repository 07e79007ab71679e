#pragma once

#include "app/scene/loaded_scenario.h"
#include "vp/platform_settings.h"

namespace hvp::app {

// Throws InputError, complete with file and line, where the scenario has no board ([wall], a host
// that solves) or one without words (`fidelity.numbers`).
void require_board_with_words(const LoadedScenario& loaded);

// What vp::BoardFunction is built from: a scenario's board and what is around it, for a host of
// another program. Nothing is meshed or assembled, as that host brings the system to be solved.
// Throws as require_board_with_words(), and for what only the host of `hvp run` gives: pictures on
// the bus.
vp::PlatformSettings outside_board(const LoadedScenario& loaded);

}  // namespace hvp::app
