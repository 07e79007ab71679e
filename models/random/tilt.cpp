#include "models/random/tilt.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hvp::random {

namespace {

// The logarithm of the share is uniform from here to 1.
const double kLogRarest = std::log(1e-12);

}  // namespace

Tilt::Tilt(Settings settings)
    : settings_(std::move(settings)), choice_(settings_.seed, "importance sampling") {
  for (const std::uint32_t draws : settings_.draws) {
    before_.push_back(draws_);
    draws_ += draws;
    if (draws > 0) ++effects_;
  }
}

std::size_t Tilt::join(std::string_view table) {
  counted_.push_back(0);
  tables_.emplace_back(table);
  return counted_.size() - 1;
}

bool Tilt::touches(std::size_t effect, std::uint32_t draw) {
  counted_[effect] = std::max(counted_[effect], draw + 1);
  return effect < settings_.draws.size() && draw < settings_.draws[effect];
}

double Tilt::share(std::size_t effect, std::int64_t frame, std::uint32_t draw, double uniform) {
  const auto number = static_cast<std::size_t>(frame / settings_.frames);
  const std::int64_t place = frame % settings_.frames;
  // Which of the block's times is long, if any, its number decides.
  const auto block = static_cast<std::int64_t>(number);
  const Draws::Pair whether = choice_.uniform(block, 0);
  const Draws::Pair which = choice_.uniform(block, 1);
  double share = uniform;
  if (whether.first < settings_.share && place == place_of(which.first)) {
    // The first half of the blocks with something long, or the second.
    double rest = 2 * whether.first / settings_.share;
    if (rest >= 1) {
      share = std::pow(uniform, kScales[static_cast<std::size_t>(which.second * kScales.size())]);
    } else {
      rest *= effects_;
      std::size_t chosen = 0;
      while (settings_.draws[chosen] == 0 || rest >= 1) {
        if (settings_.draws[chosen] > 0) --rest;
        ++chosen;
      }
      const double draws = settings_.draws[chosen];
      if (chosen == effect && draw == static_cast<std::uint32_t>(which.second * draws)) {
        share = std::exp(kLogRarest * uniform);
      }
    }
  }
  if (number >= blocks_.size()) blocks_.resize(number + 1);
  Block& drawn = blocks_[number];
  const auto frames = static_cast<std::size_t>(settings_.frames);
  if (drawn.drawn.empty()) {
    drawn.drawn.resize(frames * draws_);
    drawn.log_of_frame.resize(frames);
  }
  const std::size_t slot = static_cast<std::size_t>(place) * draws_ + before_[effect] + draw;
  if (drawn.drawn[slot]) return share;
  drawn.drawn[slot] = true;
  // What was not drawn could have been anything, in the mean as dense as without.
  const double log_share = std::log(share);
  const double density = log_share >= kLogRarest ? -1 / (share * kLogRarest) : 0;
  drawn.of_one +=
      (density - 1) / (effects_ * static_cast<double>(settings_.frames) * settings_.draws[effect]);
  for (std::size_t i = 0; i < kScales.size(); ++i) {
    drawn.log_of_frame[static_cast<std::size_t>(place)][i] +=
        (1 / kScales[i] - 1) * log_share - std::log(kScales[i]);
  }
  return share;
}

std::int64_t Tilt::place_of(double number) const {
  return static_cast<std::int64_t>(number * static_cast<double>(settings_.frames));
}

// 1 of a block that drew nothing.
double Tilt::density(const Block& block) const {
  if (block.log_of_frame.empty()) return 1;
  double of_frame = 0;
  for (const auto& frame : block.log_of_frame) {
    for (const double log_density : frame) of_frame += std::exp(log_density);
  }
  of_frame /= static_cast<double>(block.log_of_frame.size() * kScales.size());
  return 1 - settings_.share + settings_.share * 0.5 * (block.of_one + of_frame);
}

double Tilt::weight(std::int64_t first, std::int64_t last) const {
  double weight = 1;
  const std::int64_t end = std::min<std::int64_t>(last / settings_.frames,
                                                  static_cast<std::int64_t>(blocks_.size()) - 1);
  for (std::int64_t b = std::max<std::int64_t>(first, 0) / settings_.frames; b <= end; ++b) {
    weight /= density(blocks_[static_cast<std::size_t>(b)]);
  }
  return weight;
}

}  // namespace hvp::random
