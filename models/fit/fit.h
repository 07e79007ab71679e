#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "models/fit/coordinates.h"
#include "models/fit/noise.h"
#include "models/fit/problem.h"

namespace hvp::fit {

struct Attempt {
  int start = 0;  // from 1
  int starts = 0;
  int iteration = 0;
  double rms = 0;  // of the residuals so far
};

struct Options {
  std::map<std::string, double> fixed;  // parameter -> its value
  double hold_out = 0.2;                // share of the log that is not fitted; 0: none
  int starts = 8;                       // attempts; the first one from Parameter::start
  Loss loss = Loss::squares;
  std::uint64_t seed = 1;
  int most_iterations = 200;  // of an attempt
  // A search ends where an iteration changes the sum of squares by less than this share.
  double tolerance = 1e-14;
  std::function<bool(const Attempt&)> progress;  // false: stop, with the best so far
};

// What a log says of a parameter.
struct Estimate {
  std::string name;
  std::string unit;
  double value = 0;
  double low = 0;   // of the 95 % interval
  double high = 0;  // likewise
  bool fixed = false;
  bool identifiable = true;
  bool at_bound = false;
  bool profiled = false;    // the interval is from the profile likelihood
  std::string remedy = {};  // not identifiable: the log that would give it
};

struct Starts {
  int tried = 0;
  int reached = 0;  // the best optimum
  struct Other {
    double rms = 0;
    std::vector<double> values;
    int times = 0;
  };
  std::vector<Other> others;  // worse optima, the best first
};

struct Fit {
  std::vector<Estimate> parameters;
  Eigen::MatrixXd correlations;  // of those that are not fixed, in order; diagonal 1
  double residual_rms = 0;
  std::optional<double> held_out_rms;
  Starts starts;
  bool converged = false;
  bool interrupted = false;
  Whiteness whiteness;
  int noise_order = 0;  // of the autoregressive model of the residuals
  double widened = 1;   // the largest factor by which its intervals are those of white noise
  std::vector<std::string> warnings;

  // Of each stretch, at the optimum.
  std::vector<std::vector<double>> residuals;
  std::vector<std::vector<double>> own;
};

// Least squares by Ceres' trust region (Levenberg & Marquardt), from several starts; own unknowns
// of stretches are eliminated. Values come from the whole log; what is held out, the last stretches
// or, of less than five, the last rows of each, is predicted by another fit of the rest. Intervals
// hold for residuals that are alike in time: they rest on an autoregressive model of them, or,
// where the problem is not close to linear, on the profile of the sum of squares with the same
// noise. Throws InputError: nothing to fit, an unknown or inadmissible fixed parameter, fewer
// residuals than unknowns, no start at which the model has a value.
Fit fit(const Problem& problem, const Options& options);

}  // namespace hvp::fit
