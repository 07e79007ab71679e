#include "tests/fit/nist_problem.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>

#include <ceres/dynamic_autodiff_cost_function.h>
#include <ceres/jet.h>

namespace hvp::fit::test {

namespace {

template <class T>
T square(const T& v) {
  return v * v;
}

// Each model as its file states it.
template <class T>
T decays(const T* b, double x) {
  using std::exp;
  return b[0] * exp(-b[1] * x) + b[2] * exp(-b[3] * x) + b[4] * exp(-b[5] * x);
}

template <class T>
T gauss(const T* b, double x) {
  using std::exp;
  return b[0] * exp(-b[1] * x) + b[2] * exp(-square(x - b[3]) / square(b[4])) +
         b[5] * exp(-square(x - b[6]) / square(b[7]));
}

template <class T>
T cubic_over_cubic(const T* b, double x) {
  return (b[0] + b[1] * x + b[2] * x * x + b[3] * x * x * x) /
         (1.0 + b[4] * x + b[5] * x * x + b[6] * x * x * x);
}

template <class T>
T enso(const T* b, double x) {
  using std::cos;
  using std::sin;
  const double turn = 2 * std::numbers::pi * x;
  return b[0] + b[1] * std::cos(turn / 12) + b[2] * std::sin(turn / 12) + b[4] * cos(turn / b[3]) +
         b[5] * sin(turn / b[3]) + b[7] * cos(turn / b[6]) + b[8] * sin(turn / b[6]);
}

template <class T>
T roszman(const T* b, double x) {
  using std::atan;
  return b[0] - b[1] * x - atan(b[2] / (x - b[3])) / std::numbers::pi;
}

template <class T>
T of_lower_difficulty(const std::string& name, const T* b, double x) {
  using std::exp;
  using std::pow;
  if (name == "Misra1a" || name == "BoxBOD") return b[0] * (1.0 - exp(-b[1] * x));
  if (name == "Chwirut1" || name == "Chwirut2") return exp(-b[0] * x) / (b[1] + b[2] * x);
  if (name == "DanWood") return b[0] * pow(T(x), b[1]);
  if (name == "Misra1b") return b[0] * (1.0 - 1.0 / square(1.0 + b[1] * x / 2.0));
  if (name == "Misra1c") return b[0] * (1.0 - pow(1.0 + 2.0 * b[1] * x, T(-0.5)));
  if (name == "Misra1d") return b[0] * b[1] * x / (1.0 + b[1] * x);
  if (name.starts_with("Gauss")) return gauss(b, x);
  if (name.starts_with("Lanczos")) return decays(b, x);
  throw std::runtime_error("no model of " + name);
}

template <class T>
T model(const std::string& name, const T* b, const std::vector<double>& row) {
  using std::exp;
  using std::pow;
  const double x = row[0];
  if (name == "Nelson") return b[0] - b[1] * x * exp(-b[2] * row[1]);
  if (name == "Kirby2") {
    return (b[0] + b[1] * x + b[2] * x * x) / (1.0 + b[3] * x + b[4] * x * x);
  }
  if (name == "Hahn1" || name == "Thurber") return cubic_over_cubic(b, x);
  if (name == "MGH17") return b[0] + b[1] * exp(-x * b[3]) + b[2] * exp(-x * b[4]);
  if (name == "Roszman1") return roszman(b, x);
  if (name == "ENSO") return enso(b, x);
  if (name == "MGH09") return b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]);
  if (name == "MGH10") return b[0] * exp(b[1] / (x + b[2]));
  if (name == "Rat42") return b[0] / (1.0 + exp(b[1] - b[2] * x));
  if (name == "Rat43") return b[0] / pow(1.0 + exp(b[1] - b[2] * x), 1.0 / b[3]);
  if (name == "Eckerle4") return b[0] / b[1] * exp(-0.5 * square((x - b[2]) / b[1]));
  if (name == "Bennett5") return b[0] * pow(b[1] + x, -1.0 / b[2]);
  return of_lower_difficulty(name, b, x);
}

struct Residuals {
  const NistSet& set;
  template <class T>
  bool operator()(T const* const* blocks, T* residuals) const {
    using std::isfinite;
    for (std::size_t i = 0; i < set.y.size(); ++i) {
      // Nelson's model is of the logarithm.
      const double y = set.name == "Nelson" ? std::log(set.y[i]) : set.y[i];
      residuals[i] = y - model(set.name, blocks[0], set.x[i]);
      if (!isfinite(residuals[i])) return false;
    }
    return true;
  }
};

std::vector<double> numbers(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> values;
  for (double v = 0; in >> v;) values.push_back(v);
  return values;
}

}  // namespace

const std::vector<std::string>& nist_names() {
  static const std::vector<std::string> kNames{
      "Misra1a", "Chwirut2", "Chwirut1", "Lanczos3", "Gauss1", "Gauss2",   "DanWood",
      "Misra1b", "Kirby2",   "Hahn1",    "Nelson",   "MGH17",  "Lanczos1", "Lanczos2",
      "Gauss3",  "Misra1c",  "Misra1d",  "Roszman1", "ENSO",   "MGH09",    "Thurber",
      "BoxBOD",  "Rat42",    "MGH10",    "Eckerle4", "Rat43",  "Bennett5"};
  return kNames;
}

// "  b1 =   500   250   2.3894212918E+02  2.7070075241E+00", then the sum of squares, then, after a
// second line that begins with "Data:", the rows.
NistSet read_nist(const std::string& folder, const std::string& name) {
  std::ifstream file(folder + "/" + name + ".dat");
  if (!file) throw std::runtime_error("no file of " + name);
  NistSet set{.name = name, .starts = {{}, {}}, .certified = {}, .y = {}, .x = {}};
  int tables = 0;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("Data:")) {
      ++tables;
      continue;
    }
    if (tables == 2) {
      const std::vector<double> row = numbers(line);
      if (row.size() < 2) continue;
      set.y.push_back(row[0]);
      set.x.emplace_back(row.begin() + 1, row.end());
      continue;
    }
    const std::size_t equals = line.find('=');
    const std::size_t b = line.find_first_not_of(' ');
    if (tables == 1 && equals != std::string::npos && b < equals && line[b] == 'b') {
      const std::vector<double> row = numbers(line.substr(equals + 1));
      if (row.size() != 4) continue;
      set.starts[0].push_back(row[0]);
      set.starts[1].push_back(row[1]);
      set.certified.push_back(row[2]);
    }
    constexpr std::string_view kSum = "Residual Sum of Squares:";
    if (line.starts_with(kSum)) set.certified_sum = std::stod(line.substr(kSum.size()));
  }
  if (set.certified.empty() || set.y.size() <= set.certified.size()) {
    throw std::runtime_error(name + " has another form");
  }
  return set;
}

NistProblem::NistProblem(const NistSet& set, std::size_t start) : set_(set) {
  // From its first start this one, whose parameters are positive and begin a factor of 200 away, is
  // reached in logarithms only.
  const bool positive = set.name == "BoxBOD";
  for (std::size_t i = 0; i < set.certified.size(); ++i) {
    const double begin = set.starts[start][i];
    parameters_.push_back({.name = "b" + std::to_string(i + 1),
                           .unit = "",
                           .start = begin,
                           .low = positive ? 1e-9 : -std::numeric_limits<double>::infinity(),
                           .high = std::numeric_limits<double>::infinity(),
                           .because = "NIST states none",
                           .logarithmic = positive,
                           .draw_low = begin,
                           .draw_high = begin,
                           .remedy = "more data"});
  }
}

std::unique_ptr<ceres::CostFunction> NistProblem::cost(std::size_t /*stretch*/) const {
  auto cost = std::make_unique<ceres::DynamicAutoDiffCostFunction<Residuals>>(new Residuals{set_});
  cost->AddParameterBlock(static_cast<int>(parameters_.size()));
  cost->SetNumResiduals(static_cast<int>(set_.y.size()));
  return cost;
}

}  // namespace hvp::fit::test
