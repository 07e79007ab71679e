#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "models/random/draws.h"

namespace hvp::random {

// Draws long times more often than they come, and tells by how much more (importance sampling;
// Asmussen & Glynn, Stochastic Simulation, 2007, V.1 and VI). In a share of all blocks of frames
// something is long. In half of these it is one time, chosen at random among all that the block
// draws: the logarithm of the share of longer times is uniform down to 10⁻¹², so that each decade
// of rarity comes as often as any other. In the others it is all times of one frame: the logarithm
// of each share is 1.2 to 5 times as large, which of exponential times makes the mean as much
// longer. A block's weight is the density of what it drew over the density of what it draws now, in
// the mean over the choices that could have been made (the balance heuristic; Veach & Guibas,
// SIGGRAPH 1995), and is at most 1/(1 − share).
class Tilt {
 public:
  struct Settings {
    double share = 0.5;        // of the blocks that have such a time
    std::int64_t frames = 32;  // of a block
    std::int64_t seed = 0;
    // How many times each effect draws in a frame at most, in the order in which they join; empty:
    // that is to be counted, and nothing is changed.
    std::vector<std::uint32_t> draws;
  };

  explicit Tilt(Settings settings);

  // An effect that draws times, by its table; returns its number.
  std::size_t join(std::string_view table);
  // True of a draw whose share is to be taken from here. Counts it.
  bool touches(std::size_t effect, std::uint32_t draw);
  // The share of longer times; `uniform` in (0, 1) is the draw's own. The same draw may be asked
  // for again.
  double share(std::size_t effect, std::int64_t frame, std::uint32_t draw, double uniform);

  // The product of the weights of all blocks with a frame from `first` to `last`.
  double weight(std::int64_t first, std::int64_t last) const;

  // How many times each effect drew in a frame at most, and their tables.
  const std::vector<std::uint32_t>& counted() const { return counted_; }
  const std::vector<std::string>& tables() const { return tables_; }

 private:
  static constexpr std::array<double, 5> kScales = {1.2, 1.5, 2, 3, 5};
  struct Block {
    std::vector<bool> drawn;  // of each frame, effect and draw
    // Densities of what was drawn, over the uniform one: if one time had been long, and for each
    // frame and scale the logarithm of that if all of it had been.
    double of_one = 1;
    std::vector<std::array<double, kScales.size()>> log_of_frame;
  };
  double density(const Block& block) const;
  std::int64_t place_of(double number) const;  // in a block, of a number in (0, 1)

  Settings settings_;
  Draws choice_;
  double effects_ = 0;                 // that draw
  std::vector<std::uint32_t> before_;  // draws of a frame by the effects before each
  std::uint32_t draws_ = 0;            // of a frame
  std::vector<std::uint32_t> counted_;
  std::vector<std::string> tables_;
  std::vector<Block> blocks_;
};

}  // namespace hvp::random
