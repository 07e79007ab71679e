#pragma once

#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"

namespace hvp::accel {

// All that an architect can change: the engine, and the solver's words and method.
struct Design {
  Architecture architecture;
  fixed::Settings solver;
};

// A design that differs from another one in one key.
struct Variation {
  std::string key;  // key of a scenario: "accelerator.partitions"
  std::string from, to;
  bool numbers = false;  // the words that a solve gives change too
  Design design;
};

// The neighbours of a design: each number alone, doubled or halved or one step on, and each choice
// with its other values, within the ranges that a scenario may have.
std::vector<Variation> variations(const Design& design);

}  // namespace hvp::accel
