#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <ceres/cost_function.h>

namespace hvp::fit {

// Between a start and the starts that are drawn around it.
inline constexpr double kDrawFactor = 5;

// A number that a log is asked for.
struct Parameter {
  std::string name;  // "mass"
  std::string unit;  // "kg"; empty: none
  double start = 1;  // where the first attempt begins

  // Admissible values, both included, and why they end there. A logarithmic one is above zero.
  double low = 0;
  double high = 1;
  std::string because;

  // Searched, and its interval formed, in its logarithm: for what is positive and known to a
  // factor, such as a time constant.
  bool logarithmic = false;
  // Further attempts begin somewhere between these, evenly or, where logarithmic, in the logarithm.
  double draw_low = 0;
  double draw_high = 1;

  // What size of it would show in this log. An interval wider than both this and the value says
  // nothing of it.
  double matters = 0;
  // What log would give it, where this one does not: "a motion that reverses".
  std::string remedy;
};

// What a model says of a log, for fit(): residuals, observed minus modelled, as a function of
// parameters. They come in stretches, each with unknowns of its own beside the parameters, such as
// the state at its beginning; residuals of one stretch are in the order of time, evenly spaced.
class Problem {
 public:
  virtual ~Problem() = default;

  virtual const std::vector<Parameter>& parameters() const = 0;
  // Of the residuals.
  virtual std::string unit() const = 0;
  // How large what the model is to explain is, rms about its mean, in that unit; 0: not known.
  virtual double signal_rms() const { return 0; }

  virtual std::size_t stretches() const = 0;
  struct Stretch {
    std::size_t residuals = 0;
    std::vector<double> own;  // where its own unknowns begin; may be empty
  };
  virtual Stretch stretch(std::size_t index) const = 0;
  // What each residual of the stretch counts, its square in the sum: 1 for a measurement of its
  // own. Empty: all of them.
  virtual std::vector<double> weights(std::size_t /*stretch*/) const { return {}; }
  // Its first parameter block has the parameters, in their units; its second one, where there are
  // own unknowns, those. Evaluate() returns false where the model has no value.
  virtual std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const = 0;
};

}  // namespace hvp::fit
