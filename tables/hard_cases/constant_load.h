#pragma once

#include <string>

#include "models/fixed/settings.h"

namespace hvp::tables {

// The result of frames with a constant load, each started from the previous solution. The body is a
// cube of six tetrahedra with four free nodes, so that a million frames take seconds.
struct ConstantLoad {
  int frames = 0;
  // The last frame in which a word of u changed; 0: no word changed. The words are the whole state
  // of a static solve, so after a frame without a change nothing changes any more.
  int last_change = 0;
  // The number of frames after which the words repeat; 1: they are constant, 0: they do not repeat
  // in the second half of the frames.
  int period = 0;
  // The largest distance of a word from the solution of the rounded system, in units of the last
  // place, over the last quarter of the frames and over the quarter before it.
  double distance = 0;
  double distance_before = 0;
};

ConstantLoad static_load(fixed::Method method, int frames);
// Uses Newmark's rule with the thesis' time step of 2 ms. The load starts in frame one.
ConstantLoad dynamic_load(fixed::Method method, int passes, int frames);

}  // namespace hvp::tables
