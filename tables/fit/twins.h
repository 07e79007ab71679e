#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "models/fit/fit.h"

namespace hvp::tables {

// A model whose log another part of the program generates, so that the true parameters are known.
struct Twin {
  std::string model;
  std::string log;  // describes the log: "4 s at 1 kHz, 20 um of white noise"
  std::vector<std::pair<std::string, double>> truth;
  std::function<fit::Fit(std::int64_t)> fit;  // fits the log with the noise of a seed
};
std::vector<Twin> twins();

// The coverage of one parameter over many seeds.
struct Coverage {
  std::string parameter;
  double truth = 0;
  double covered = 0;       // share of the intervals that contain it
  double identifiable = 0;  // share of the fits that find it identifiable
  double mean_square = 0;   // of the error
  double half_width = 0;    // of the intervals, mean
};
std::vector<Coverage> coverage_of(const Twin& twin, int seeds);

}  // namespace hvp::tables
