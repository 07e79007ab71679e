#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/scene/scene.h"

namespace hvp::app {

struct FrameStep {
  std::string what;
  std::int64_t ps = 0;       // each time
  int times = 1;             // a frame: passes of refinement repeat some
  bool after_force = false;  // of the load, and not of the latency
};

// What a frame's large steps cost without contact, in order, by the annotated costs of host and
// bus and the closed form of the accelerator.
std::vector<FrameStep> frame_steps(const Scene& scene);

// The same for a system with another number of nodes, whose solve takes `solve_ps`: the host's
// operations and the bytes on the bus grow with the nodes.
std::vector<FrameStep> frame_steps(const Scene& scene, int nodes, std::int64_t solve_ps);

// All of them, one after the other, and those that the force waits for.
std::int64_t frame_ps(const std::vector<FrameStep>& steps);
std::int64_t latency_ps(const std::vector<FrameStep>& steps);

}  // namespace hvp::app
