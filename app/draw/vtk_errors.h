#pragma once

#include <string>

namespace hvp::draw {

// Keeps the messages that VTK would print on stderr, so that the user sees one line of ours
// instead.
class VtkErrors {
 public:
  // Replaces VTK's output window for the rest of the process.
  static void capture();
  // True if VTK reported an error since the last call.
  static bool take();
};

}  // namespace hvp::draw
