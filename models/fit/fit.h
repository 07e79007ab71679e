#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "models/fit/between_logs.h"
#include "models/fit/coordinates.h"
#include "models/fit/noise.h"
#include "models/fit/problem.h"

namespace hvp::fit {

struct Attempt {
  int start = 0;  // number of the start, from 1
  int starts = 0;
  int iteration = 0;
  double rms = 0;  // the residuals' rms so far
};

struct Options {
  std::map<std::string, double> fixed;  // parameter -> its value
  double hold_out = 0.2;  // the share of the log that is not fitted but predicted; 0: none
  int starts = 8;         // number of attempts; the first begins at Parameter::start
  Loss loss = Loss::squares;
  std::uint64_t seed = 1;
  int most_iterations = 200;  // the limit of an attempt
  // A search ends when an iteration changes the sum of squares by less than this share.
  double tolerance = 1e-14;
  std::function<bool(const Attempt&)> progress;  // false: stop with the best so far
};

// A parameter's value and interval as the log gives them.
struct Estimate {
  std::string name;
  std::string unit;
  double value = 0;
  double low = 0;   // lower end of the 95 % interval
  double high = 0;  // upper end
  bool fixed = false;
  bool identifiable = true;
  bool at_bound = false;
  bool profiled = false;    // the interval follows from the profile likelihood
  std::string remedy = {};  // for one that is not identifiable: the log that would give it
  std::optional<BetweenLogs> between = {};  // of several logs, or quarters of one
};

struct Starts {
  int tried = 0;
  int reached = 0;  // how many of them reached the best optimum
  struct Other {
    double rms = 0;
    std::vector<double> values;
    int times = 0;
  };
  std::vector<Other> others;  // worse optima, the best first
};

struct Fit {
  std::vector<Estimate> parameters;
  Eigen::MatrixXd correlations;  // in order, without the fixed ones; diagonal 1
  double residual_rms = 0;
  std::optional<double> held_out_rms;
  Starts starts;
  bool converged = false;
  bool interrupted = false;
  Whiteness whiteness;
  int noise_order = 0;  // the order of the residuals' autoregressive model
  double widened = 1;   // the largest ratio of an interval to that for white noise
  std::vector<std::string> warnings;

  // The residuals and the own unknowns of each stretch at the optimum.
  std::vector<std::vector<double>> residuals;
  std::vector<std::vector<double>> own;
};

// Fits a problem by least squares with Ceres' trust region (Levenberg & Marquardt) from several
// starts; the stretches' own unknowns are eliminated. The values follow from the whole log. The
// held-out part, which is the last stretches or, where there are fewer than five, the last rows of
// each, is predicted by another fit of the rest. The intervals are valid for residuals that are
// alike in time: they rest on an autoregressive model of them or, where the problem is not close to
// linear, on the profile of the sum of squares with the same noise. Throws InputError: nothing to
// fit, an unknown or inadmissible fixed parameter, fewer residuals than unknowns, no start at which
// the model has a value.
Fit fit(const Problem& problem, const Options& options);

// The warnings that a user needs before trusting the values: one line each, the gravest first.
std::vector<std::string> warnings_of(const Fit& fit, const Problem& problem,
                                     const Options& options);

}  // namespace hvp::fit
