#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/results/flags.h"
#include "models/stability/flag.h"

namespace hvp::app {

// What a whole run came to.
struct WholeRun {
  stability::Flags flags;
  bool held = false;
  std::string verdict;
  results::TriedRemedy::Cost worst = {};  // over all its frames
  std::vector<std::string> remedy = {};   // its own, where one was looked for
};

// Runs the whole scenario with further overrides, in the form of `--set`; absent where the run
// failed.
using Rerun =
    std::function<std::optional<WholeRun>(const std::vector<std::string>& override_texts)>;

// Runs the whole scenario with the settings of `remedy`, as they are printed, and writes down which
// of the run's flags they take away and which stay. A remedy that could not be run keeps what its
// trial on a part of the run has shown, and the flags that the trial does not judge stay.
void verify(results::TriedRemedy& remedy, stability::Flags of_run, const Rerun& rerun);

// A run that is in need of a remedy.
struct Trouble {
  stability::Flags flags;
  bool held = true;  // every budget held: with a remedy it has to hold, too
  int frames = 0;
  // Search on for a PASS where one without flags is held with another word.
  bool wants_pass = true;
};

// Runs the whole scenario with each candidate in turn. Of those that raise no flags of their own
// and break no budget it takes the one with the fewest flags. Absent where nothing could be run.
std::optional<results::TriedRemedy> try_whole_runs(
    const Trouble& trouble, const std::vector<std::vector<std::string>>& candidates,
    const Rerun& rerun);

}  // namespace hvp::app
