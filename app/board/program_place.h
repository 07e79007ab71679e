#pragma once

#include "vp/function/driver_finding.h"

// Where the program of the C library stands when it makes an access: for what is said of its
// driver.
namespace hvp::app {

// The stack of whoever calls this, as return addresses. Looks up no name.
vp::HostPlace own_stack();

// Sets `program_counter` and `function` of a finding: the innermost three functions that are not of
// the board's library, by the symbols of the program and its libraries. Leaves both where there are
// none.
void name_place(const vp::HostPlace& place, vp::DriverFinding& finding);

}  // namespace hvp::app
