#pragma once

#include <string>

namespace hvp::results {

// Whether an X server listens at a local display (":0", ":0.0", "unix:1"). A display of another
// machine counts as not reachable: OpenGL through it is too old for VTK.
bool local_display_answers(const std::string& display);

}  // namespace hvp::results
