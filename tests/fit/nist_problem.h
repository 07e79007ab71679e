#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/fit/problem.h"

namespace hvp::fit::test {

// A file of NIST's Statistical Reference Datasets for nonlinear regression
// (https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml), as it is.
struct NistSet {
  std::string name;
  std::vector<std::vector<double>> starts;  // two, the second one the nearer
  std::vector<double> certified;
  double certified_sum = 0;  // of squared residuals
  std::vector<double> y;
  std::vector<std::vector<double>> x;  // of each row; Nelson has two, the others one
};

// The names of all files.
const std::vector<std::string>& nist_names();
// Throws std::runtime_error where the file is missing or has another form.
NistSet read_nist(const std::string& folder, const std::string& name);

// Its model, from one of its starts, without bounds.
class NistProblem : public Problem {
 public:
  NistProblem(const NistSet& set, std::size_t start);

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "1"; }
  std::size_t stretches() const override { return 1; }
  Stretch stretch(std::size_t /*index*/) const override { return {set_.y.size(), {}}; }
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

 private:
  const NistSet& set_;
  std::vector<Parameter> parameters_;
};

}  // namespace hvp::fit::test
