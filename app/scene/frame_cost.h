#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/scene/scene.h"

namespace hvp::app {

struct FrameStep {
  std::string what;
  std::int64_t ps = 0;       // of one execution
  int times = 1;             // executions in a frame; more than one with passes of refinement
  bool after_force = false;  // counts in the load, but not in the latency
};

// The large steps of a frame without contact and their times, in order, from the annotated costs of
// host and bus and the closed form of the accelerator.
std::vector<FrameStep> frame_steps(const Scene& scene);

// The same steps for a system with another number of nodes, whose solve takes `solve_ps`. The
// host's operations and the bytes on the bus grow with the nodes.
std::vector<FrameStep> frame_steps(const Scene& scene, int nodes, std::int64_t solve_ps);

// What a frame that renews the matrix takes on top of its steps, in order and after the force;
// empty where it is never renewed.
std::vector<FrameStep> renewal_steps(const Scene& scene);

// The time of all steps in sequence, and of the steps for which the force waits.
std::int64_t frame_ps(const std::vector<FrameStep>& steps);
std::int64_t latency_ps(const std::vector<FrameStep>& steps);

}  // namespace hvp::app
