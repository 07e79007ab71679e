#pragma once

#include <filesystem>
#include <stdexcept>

#include "app/remedy/remedy.h"
#include "app/remedy/wall_remedy.h"
#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::app {

// There is nothing to show for.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted before the first frame") {}
};

struct RunOptions {
  std::filesystem::path directory;  // is there and may be written into
  std::filesystem::path device;     // the device's file; empty for a built-in one
  bool trace_registers = false;
  bool record_jobs = false;  // of a scenario whose board has words (require_board_with_words())
  Progress progress;
  // For the remedies of flags; without them none is tried.
  Rebuild rebuild;
  Rerun rerun;
};

// Simulates the scene and writes every result file but the pictures, in place of those of an
// earlier run; a run that fails leaves none. One that is interrupted (interruption.h) ends after
// the frame at hand and writes what was done; before the first frame it throws Interrupted. Once in
// a process: SystemC elaborates once.
results::Outcome run(Scene& scene, const RunOptions& options);

}  // namespace hvp::app
