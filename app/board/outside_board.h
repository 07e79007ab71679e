#pragma once

#include "app/scene/loaded_scenario.h"
#include "vp/platform_settings.h"

namespace hvp::app {

// Throws InputError, complete with file and line, if the scenario has no board ([wall], a host that
// solves) or a board without words (`fidelity.numbers`).
void require_board_with_words(const LoadedScenario& loaded);

// The settings from which vp::BoardFunction is built for a host in another program: the scenario's
// board and its surroundings. Nothing is meshed or assembled, as that host brings the system to be
// solved. Throws as require_board_with_words() does, and if the scenario has an effect that only
// the host of `hvp run` provides: pictures on the bus.
vp::PlatformSettings outside_board(const LoadedScenario& loaded);

}  // namespace hvp::app
