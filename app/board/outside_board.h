#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/scene/loaded_scenario.h"
#include "vp/function/driver_rules.h"
#include "vp/function/outside_host.h"
#include "vp/platform_settings.h"

namespace hvp::app {

// The settings from which vp::BoardFunction is built for a host in another program: the scenario's
// board and its surroundings. Nothing is meshed or assembled, as that host brings the system to be
// solved. Throws as require_board_with_words() does, and if the scenario has an effect that only
// the host of `hvp run` provides: pictures on the bus.
vp::PlatformSettings outside_board(const LoadedScenario& loaded);

// Throws InputError if the scenario has a weak order of memory: `who` cannot tell of barriers.
void require_strong_order(const LoadedScenario& loaded, std::string_view who);

// A warning for each [[fault]] that did not happen, with why: it would pass for one that was
// survived. For hosts that print no report.
void warn_of_faults_that_never_struck(vp::BoardFunction& board);

// Throws InputError for a word of --stop-at that is no point, before anything is written.
void require_stops(const std::vector<std::string>& points);
// A warning of a point of --stop-at (StopPoints::never_came()); none of an empty one.
void warn_of_a_stop_that_never_came(const std::string& never);

// Watches the driver: each rule that it breaks is a warning when it happens first. To be called
// before the simulation begins. Keeps references.
void watch_driver(vp::DriverRules& rules, vp::BoardFunction& board);

}  // namespace hvp::app
