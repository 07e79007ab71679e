#pragma once

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <ceres/autodiff_cost_function.h>
#include <ceres/dynamic_autodiff_cost_function.h>

#include "models/fit/problem.h"
#include "models/fit/twins.h"

namespace hvp::fit::test {

inline Parameter parameter(std::string name, double start, double low, double high,
                           bool logarithmic = false) {
  Parameter p;
  p.name = std::move(name);
  p.start = start;
  p.low = p.draw_low = low;
  p.high = p.draw_high = high;
  p.because = "a test";
  p.logarithmic = logarithmic;
  p.remedy = "another log";
  return p;
}

// y = f(parameters, x), one stretch.
template <class Function>
class Curve : public Problem {
 public:
  Curve(std::vector<Parameter> parameters, std::vector<double> x, std::vector<double> y,
        Function function)
      : parameters_(std::move(parameters)),
        x_(std::move(x)),
        y_(std::move(y)),
        function_(std::move(function)) {}

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "1"; }
  std::size_t stretches() const override { return 1; }
  Stretch stretch(std::size_t /*index*/) const override { return {x_.size(), {}}; }
  std::unique_ptr<ceres::CostFunction> cost(std::size_t /*stretch*/) const override {
    auto cost =
        std::make_unique<ceres::DynamicAutoDiffCostFunction<Residuals>>(new Residuals{*this});
    cost->AddParameterBlock(static_cast<int>(parameters_.size()));
    cost->SetNumResiduals(static_cast<int>(x_.size()));
    return cost;
  }

 private:
  struct Residuals {
    const Curve& curve;
    template <class T>
    bool operator()(T const* const* blocks, T* residuals) const {
      for (std::size_t i = 0; i < curve.x_.size(); ++i) {
        residuals[i] = curve.y_[i] - curve.function_(blocks[0], curve.x_[i]);
      }
      return true;
    }
  };

  std::vector<Parameter> parameters_;
  std::vector<double> x_;
  std::vector<double> y_;
  Function function_;
};

inline std::vector<double> evenly(std::size_t count, double from, double to) {
  std::vector<double> x(count);
  for (std::size_t i = 0; i < count; ++i) {
    x[i] = from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1);
  }
  return x;
}

// Normal noise, r_t = colour·r_{t−1} + e, of this standard deviation.
inline std::vector<double> noise(std::size_t count, double deviation, double colour,
                                 unsigned seed) {
  std::mt19937_64 generator(seed);
  const auto uniform = [&] {
    return (static_cast<double>(generator() >> 11U) + 0.5) * std::ldexp(1.0, -53);
  };
  std::vector<double> r(count);
  double last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const random::Draws::Pair pair{uniform(), uniform()};
    const double share = i == 0 ? 1 : std::sqrt(1 - colour * colour);
    last = colour * last + gaussian(pair, share * deviation);
    r[i] = last;
  }
  return r;
}

}  // namespace hvp::fit::test
