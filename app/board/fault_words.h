#pragma once

#include <string_view>

#include "app/scene/scenario.h"
#include "vp/function/outside_host.h"

namespace hvp::app {

// Adds a fault to a board that runs, in the words of an item of [[fault]] with commas between them:
// "kind=master-abort,access=status". A frame is a job. Without `frame` and `rate` the fault strikes
// from now on where it can next, and with `count` in so many jobs. Throws InputError, in one line,
// and changes nothing, for what a scenario may not say either, and for a job that is over.
void inject_fault(vp::BoardFunction& board, const Scenario& scenario, std::string_view words);

}  // namespace hvp::app
