#pragma once

#include <filesystem>

namespace hvp::sample {

struct LoopShape {
  int probes = 1;
  bool held = true;           // by a hand: else nothing is intended
  double swing_N = 0.0;       // of the motor's force, up in one frame and down in the next
  double absorbed_J = 0.002;  // by the loop at the end, growing from zero
};

// Adds the columns of a closed loop to the frames.csv in the directory: each probe moves along z,
// 20 mm up and down and 2 mm aside, further ones 5 mm higher each.
void add_loop(const std::filesystem::path& directory, const LoopShape& shape);

}  // namespace hvp::sample
