#pragma once

#include <filesystem>

#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::app {

struct RunOptions {
  std::filesystem::path directory;
  bool trace_registers = false;
  Progress progress;
};

// Simulates the scene and writes every result file but the pictures. Once in a process: SystemC
// elaborates once.
results::Outcome run(Scene& scene, const RunOptions& options);

}  // namespace hvp::app
