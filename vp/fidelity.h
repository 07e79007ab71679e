#pragma once

#include "models/config/declaration.h"

namespace hvp::vp {

// How finely a part that is there is modelled. Levels that a part does not have are not listed,
// so that asking for one is an error.
enum class Timing { untimed, loosely_timed, approximately_timed, cycle_accurate };
enum class Numbers {
  fixed,  // bit-true words
  none,   // timing only: nobody computes words, and every solve makes all its iterations
};

// The scenario's table [fidelity].
struct Fidelity {
  Timing accelerator = Timing::loosely_timed;
  Timing bus = Timing::loosely_timed;
  Timing host = Timing::loosely_timed;
  Numbers numbers = Numbers::fixed;

  // `body`: where there is one, and not a wall.
  void declare(config::Visitor& v,
               const config::Condition& body = config::not_beside("wall", false, {}));
};

const char* name(Timing level);
// Of an accelerator: something else than a closed form says how long a solve takes.
bool has_engine(Timing level);
const char* name(Numbers level);

}  // namespace hvp::vp
