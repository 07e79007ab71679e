#pragma once

#include <filesystem>
#include <stdexcept>

#include "app/remedy/find_remedy.h"
#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::app {

// The run was interrupted before it had a result.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted before the first frame") {}
};

struct RunOptions {
  std::filesystem::path directory;  // exists and may be written into
  std::filesystem::path device;     // the device's file; empty for a built-in one
  bool trace_registers = false;
  bool trace_dma = false;
  bool record_jobs = false;  // of a scenario whose board has words (require_board_with_words())
  Progress progress;
  Again again;  // for the remedies of flags
};

// Simulates the scene and writes every result file but the pictures, in place of those of an
// earlier run; a run that fails leaves none. An interrupted run (results/part_files.h) ends after
// the current frame and writes what was done; before the first frame it throws Interrupted. Call it
// once in a process: SystemC elaborates once.
results::Outcome run(Scene& scene, const RunOptions& options);

}  // namespace hvp::app
