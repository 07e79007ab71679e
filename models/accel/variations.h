#pragma once

#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"

namespace hvp::accel {

// All that an architect can turn: the engine, and of the solver what it stores and multiplies.
struct Design {
  Architecture architecture;
  fixed::Settings solver;
};

// A design in which one number differs.
struct Variation {
  std::string key;  // of a scenario: "accelerator.partitions"
  std::string from, to;
  bool numbers = false;  // the words that a solve gives change too
  Design design;
};

// The neighbours of a design that a "what if" asks for first: each number alone, doubled or halved
// or one step on, each choice with its other values. Within the ranges that a scenario may have.
std::vector<Variation> variations(const Design& design);

}  // namespace hvp::accel
