#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <ceres/cost_function.h>

namespace hvp::fit {

// The factor between a start and the ends of the range from which further starts are drawn.
inline constexpr double kDrawFactor = 5;

// A parameter that a log is to give.
struct Parameter {
  std::string name;  // "mass"
  std::string unit;  // "kg"; empty: none
  double start = 1;  // the start of the first attempt

  // The admissible values, both included, and the reason for these bounds. A logarithmic parameter
  // is above zero.
  double low = 0;
  double high = 1;
  std::string because;

  // The parameter is searched, and its interval formed, in its logarithm. That suits what is
  // positive and known to a factor, such as a time constant.
  bool logarithmic = false;
  // Further attempts begin between these two values, evenly distributed, or evenly in the logarithm
  // where the parameter is logarithmic.
  double draw_low = 0;
  double draw_high = 1;

  // The size at which the parameter would show in this log. An interval wider than both this and
  // the value says nothing of the parameter.
  double matters = 0;
  // The log that would give the parameter, where this one does not: "a motion that reverses".
  std::string remedy;
};

// A model of a log, for fit(). Its residuals, observed minus modelled, are functions of the
// parameters. They come in stretches, each with unknowns of its own beside the parameters, such as
// the state at its beginning. The residuals of one stretch are in the order of time, evenly spaced.
class Problem {
 public:
  virtual ~Problem() = default;

  virtual const std::vector<Parameter>& parameters() const = 0;
  // The unit of the residuals.
  virtual std::string unit() const = 0;
  // The size of what the model is to explain: its rms about its mean, in that unit. 0: not known.
  virtual double signal_rms() const { return 0; }

  virtual std::size_t stretches() const = 0;
  struct Stretch {
    std::size_t residuals = 0;
    std::vector<double> own;  // the start of its own unknowns; may be empty
  };
  virtual Stretch stretch(std::size_t index) const = 0;
  // The weight of each residual's square in the sum; 1 for a measurement of its own. Empty: all are
  // 1.
  virtual std::vector<double> weights(std::size_t /*stretch*/) const { return {}; }
  // The cost function of a stretch. Its first parameter block is the parameters, in their units;
  // its second one, where there are own unknowns, is those. Evaluate() returns false where the
  // model has no value.
  virtual std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const = 0;
};

}  // namespace hvp::fit
