#pragma once

#include "models/config/declaration.h"

namespace hvp::vp {

// The levels of detail at which a part's time is modelled. A part's key lists only the levels that
// the part has, so that any other is an error.
enum class Timing { untimed, loosely_timed, approximately_timed, cycle_accurate, rtl };
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

  // `body` is the condition that the scene has a body, not a wall.
  void declare(config::Visitor& v,
               const config::Condition& body = config::not_beside("wall", false, {}));
};

const char* name(Timing level);
// True if an engine, not the closed form, determines how long the accelerator's solves take.
bool has_engine(Timing level);
// True if that engine makes the words, too.
bool engine_has_words(Timing level);
const char* name(Numbers level);

}  // namespace hvp::vp
