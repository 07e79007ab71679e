#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "models/fit/fit.h"

namespace hvp::tables {

// A model whose log another part of the program makes, so that the truth is known.
struct Twin {
  std::string model;
  std::string log;  // what it is like: "4 s at 1 kHz, 20 um of white noise"
  std::vector<std::pair<std::string, double>> truth;
  std::function<fit::Fit(std::int64_t)> fit;  // of the log with this seed's noise
};
std::vector<Twin> twins();

// What becomes of a parameter over many seeds.
struct Coverage {
  std::string parameter;
  double truth = 0;
  double covered = 0;       // share of the intervals that contain it
  double identifiable = 0;  // share of the fits that say so
  double mean_square = 0;   // of the error
  double half_width = 0;    // of the intervals, mean
};
std::vector<Coverage> coverage_of(const Twin& twin, int seeds);

}  // namespace hvp::tables
