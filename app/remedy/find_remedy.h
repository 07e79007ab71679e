#pragma once

#include <optional>

#include "app/remedy/loop_remedy.h"
#include "app/remedy/remedy.h"
#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::app {

// What a search for a remedy runs again. Where one is empty, nothing is tried with it.
struct Again {
  Rebuild rebuild;  // the scene
  Rerun rerun;      // the whole run
  Rerun search;     // the whole run, with a search for its own remedy
};

// Searches a remedy for a run's flags: first for those of the words and of the hand-over, by
// solving recorded frames again (`recorder`, null where there is no body), then for locking and for
// the flags of the loop. Either is then run as it is printed. Absent where nothing was looked for.
std::optional<results::TriedRemedy> find_remedy(const Scene& scene, const results::Outcome& outcome,
                                                const Recorder* recorder, const Again& searched,
                                                const Progress& progress);

}  // namespace hvp::app
