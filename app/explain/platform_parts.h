#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/scene/scene.h"

namespace hvp::app {

// A process of SystemC.
struct PlatformProcess {
  std::string name;  // "servo.run"
  std::string kind;  // "thread" or "method"
};

// A module with its own processes. Modules inside it are listed separately with theirs.
struct PlatformModule {
  std::string name;  // "pcie.down"
  std::string kind;  // the class: "PcieDirection"
  std::vector<PlatformProcess> processes;
};

struct PlatformParts {
  std::vector<PlatformModule> modules;  // in the order of construction

  std::size_t processes() const;
};

// Lists the modules and processes of a scene's platform. The platform is built, inspected and
// destroyed in a process of its own. Throws as the platform does.
PlatformParts platform_parts(Scene& scene);

}  // namespace hvp::app
