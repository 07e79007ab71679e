#pragma once

#include <string>

#include "models/fixed/settings.h"

namespace hvp::tables {

// Frames of constant load, each started from the last one's solution: what becomes of the words.
// The body is a cube of six tetrahedra with four free nodes, so that a million frames take
// seconds.
struct ConstantLoad {
  int frames = 0;
  // The last frame in which a word of u changed; 0: none did. The state of a static solve is its
  // words alone, so from a frame without a change on nothing ever changes again.
  int last_change = 0;
  // Frames after which the words repeat; 1: they stand still, 0: they do not repeat in the second
  // half of the frames.
  int period = 0;
  // The largest distance of a word from the solution of the rounded system, in units of the last
  // place, over the last quarter of the frames and over the quarter before it.
  double distance = 0;
  double distance_before = 0;
};

ConstantLoad static_load(fixed::Method method, int frames);
// Under Newmark's rule with the thesis' step of 2 ms; the load starts in frame one.
ConstantLoad dynamic_load(fixed::Method method, int passes, int frames);

}  // namespace hvp::tables
