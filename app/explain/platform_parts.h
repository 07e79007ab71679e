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

// A module, and the processes that are its own; those of modules within stand with these.
struct PlatformModule {
  std::string name;  // "pcie.down"
  std::string kind;  // its class: "PcieDirection"
  std::vector<PlatformProcess> processes;
};

struct PlatformParts {
  std::vector<PlatformModule> modules;  // in the order of their construction

  std::size_t processes() const;
};

// What the platform of a scene consists of, from the platform itself: it is built, looked at and
// taken down, in a process of its own. Throws as the platform does.
PlatformParts platform_parts(Scene& scene);

}  // namespace hvp::app
