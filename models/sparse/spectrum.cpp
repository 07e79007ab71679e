#include "models/sparse/spectrum.h"

#include <Eigen/Dense>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace hvp::sparse {
namespace {

using Vector = std::vector<double>;

constexpr int kLanczosSteps = 60;
constexpr int kMostRefinements = 30;
constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;

// Higham's γ_k: k roundings in a row are off by at most this, relative.
double gamma(double roundings) { return roundings * kUnit / (1 - roundings * kUnit); }

double dot(const Vector& x, const Vector& y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
  return sum;
}

void add(double factor, const Vector& x, Vector& y) {
  for (std::size_t i = 0; i < x.size(); ++i) y[i] += factor * x[i];
}

// False where nothing is left of x.
bool normalise(Vector& x) {
  const double norm = std::sqrt(dot(x, x));
  if (!std::isnormal(norm)) return false;
  for (double& entry : x) entry /= norm;
  return true;
}

// Entries in [-1, 1) from a fixed linear congruential sequence (Knuth's MMIX constants): no
// eigenvector of a real body is orthogonal to it.
Vector start_vector(std::size_t size) {
  Vector x(size);
  std::uint64_t state = 1;
  for (double& entry : x) {
    state = 6364136223846793005U * state + 1442695040888963407U;
    entry = static_cast<double>(state >> 11U) * 0x1p-52 - 1;
  }
  normalise(x);
  return x;
}

// The unit vector that Lanczos' method, orthogonalised in full, has for the largest eigenvalue of
// the operator apply(x, y): y = B·x.
template <class Apply>
Vector largest_ritz_vector(std::size_t size, const Apply& apply) {
  std::vector<Vector> basis = {start_vector(size)};
  Vector diagonal;
  Vector beside;
  Vector next(size);
  while (true) {
    apply(basis.back(), next);
    diagonal.push_back(dot(basis.back(), next));
    const double before = std::sqrt(dot(next, next));
    // Twice: once leaves what cancellation hides (Kahan and Parlett's "twice is enough").
    for (int pass = 0; pass < 2; ++pass) {
      for (const Vector& q : basis) add(-dot(q, next), q, next);
    }
    const double rest = std::sqrt(dot(next, next));
    const bool invariant = !(rest > 1e-12 * before);
    if (invariant || basis.size() == kLanczosSteps || basis.size() == size) break;
    beside.push_back(rest);
    basis.push_back(next);
    if (!normalise(basis.back())) break;
  }
  const auto count = static_cast<Eigen::Index>(diagonal.size());
  const Eigen::VectorXd off =
      Eigen::Map<const Eigen::VectorXd>(beside.data(), std::max<Eigen::Index>(count - 1, 0));
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz;
  ritz.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), count), off);
  Vector x(size, 0.0);
  for (Eigen::Index k = 0; k < count; ++k) {
    add(ritz.eigenvectors()(k, count - 1), basis[static_cast<std::size_t>(k)], x);
  }
  normalise(x);
  return x;
}

class Bounds {
 public:
  Bounds(const BlockMatrix& a, double relative_width)
      : size_(static_cast<std::size_t>(a.rows())), width_(relative_width) {
    // A shift needs a place on the diagonal of every row.
    Eigen::SparseMatrix<double> zero(a.rows(), a.rows());
    zero.setIdentity();
    zero *= 0.0;
    a_ = a.to_eigen() + zero;
    a_.makeCompressed();
    shifted_ = a_;
    factor_.analyzePattern(a_);
    row_sums();
  }

  Spectrum find() {
    Spectrum spectrum;
    spectrum.largest = largest();
    spectrum.smallest = smallest();
    return spectrum;
  }

 private:
  // Gershgorin's discs, and ‖A‖∞.
  void row_sums() {
    lowest_ = std::numeric_limits<double>::infinity();
    highest_ = -lowest_;
    for (int c = 0; c < a_.outerSize(); ++c) {
      double centre = 0;
      double radius = 0;
      for (Eigen::SparseMatrix<double>::InnerIterator it(a_, c); it; ++it) {
        if (it.row() == it.col()) {
          centre += it.value();
        } else {
          radius += std::abs(it.value());
        }
      }
      const double error = gamma(static_cast<double>(size_)) * (std::abs(centre) + radius);
      lowest_ = std::min(lowest_, centre - radius - error);
      highest_ = std::max(highest_, centre + radius + error);
      norm_ = std::max(norm_, std::abs(centre) + radius);
    }
  }

  void multiply(const Vector& x, Vector& y) const {
    std::fill(y.begin(), y.end(), 0.0);
    for (int c = 0; c < a_.outerSize(); ++c) {
      const double factor = x[static_cast<std::size_t>(c)];
      for (Eigen::SparseMatrix<double>::InnerIterator it(a_, c); it; ++it) {
        y[static_cast<std::size_t>(it.row())] += it.value() * factor;
      }
    }
  }

  double rayleigh(const Vector& x) const {
    Vector y(size_);
    multiply(x, y);
    return dot(x, y) / dot(x, x);
  }
  double rayleigh_error() const { return gamma(2.0 * static_cast<double>(size_) + 8) * norm_; }

  // Factorises sign · (A - shift · I). True: it ran to its end.
  bool factorise(double sign, double shift) {
    double trace = 0;
    for (int c = 0; c < a_.outerSize(); ++c) {
      Eigen::SparseMatrix<double>::InnerIterator to(shifted_, c);
      for (Eigen::SparseMatrix<double>::InnerIterator it(a_, c); it; ++it, ++to) {
        const bool diagonal = it.row() == it.col();
        to.valueRef() = sign * (diagonal ? it.value() - shift : it.value());
        if (diagonal) trace += std::abs(to.value());
      }
    }
    error_ = gamma(static_cast<double>(size_) + 3) * trace * 1.01;
    factor_.factorize(shifted_);
    return factor_.info() == Eigen::Success;
  }

  Interval largest() {
    const auto apply = [this](const Vector& x, Vector& y) { multiply(x, y); };
    // Shifted by Gershgorin's lower bound the largest eigenvalue is the largest in magnitude,
    // and Lanczos' method does not mind a shift.
    const double estimate = rayleigh(largest_ritz_vector(size_, apply));
    Interval found{estimate - rayleigh_error(), highest_};
    const double magnitude = std::max(std::abs(estimate), kUnit * norm_);
    for (double margin = width_ / 4; estimate + margin * magnitude < highest_; margin *= 2) {
      const double shift = estimate + margin * magnitude;
      if (!factorise(-1, shift)) continue;
      found.upper = std::min(found.upper, shift + error_);
      break;
    }
    return found;
  }

  // A shift below the smallest eigenvalue, with its factors in place: zero where A is positive
  // definite. None where even a shift by ‖A‖∞ is lost in rounding: a matrix of zeros.
  std::optional<double> shift_below() {
    if (factorise(1, 0)) return 0;
    for (int exponent = -30; exponent <= 0; exponent += 2) {
      const double shift = -std::ldexp(norm_, exponent);
      if (!(shift > lowest_)) break;
      if (factorise(1, shift)) return shift;
    }
    // Gershgorin's bound may be an eigenvalue itself.
    for (int exponent = -40; exponent <= 0; exponent += 2) {
      const double shift = lowest_ - std::ldexp(norm_, exponent);
      if (factorise(1, shift)) return shift;
    }
    return std::nullopt;
  }

  Interval smallest() {
    const std::optional<double> below = shift_below();
    if (!below) return {lowest_, rayleigh(start_vector(size_)) + rayleigh_error()};
    double shift = *below;
    Interval found{std::max(shift - error_, lowest_), std::numeric_limits<double>::infinity()};
    const auto apply = [this](const Vector& x, Vector& y) {
      const auto rows = static_cast<Eigen::Index>(size_);
      Eigen::Map<Eigen::VectorXd>(y.data(), rows) =
          factor_.solve(Eigen::Map<const Eigen::VectorXd>(x.data(), rows));
    };
    for (int round = 0; round < kMostRefinements; ++round) {
      const double above = rayleigh(largest_ritz_vector(size_, apply)) + rayleigh_error();
      found.upper = std::min(found.upper, above);
      const double noise = 2 * (error_ + rayleigh_error());
      const double wanted = std::max(width_ * std::abs(found.upper), noise);
      if (found.upper - found.lower <= wanted) break;
      double next = found.upper - wanted / 2;
      while (next > shift && !factorise(1, next)) next = shift + (next - shift) / 2 - noise;
      if (!(next > shift)) break;
      shift = next;
      found.lower = std::max(found.lower, shift - error_);
    }
    return found;
  }

  Eigen::SparseMatrix<double> a_;
  Eigen::SparseMatrix<double> shifted_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>> factor_;
  std::size_t size_;
  double width_;
  double lowest_ = 0;   // no eigenvalue is below
  double highest_ = 0;  // nor above
  double norm_ = 0;
  double error_ = 0;  // of the last factorisation's proof
};

}  // namespace

void SpectrumSettings::declare(config::Visitor& v) {
  v.quantity("relative_width", relative_width, config::Dimension::dimensionless,
             config::between(1e-6, 0.5),
             {.help = "how narrow the bounds of each extreme eigenvalue have to be, relative to it",
              .source = "a condition number to two digits"});
}

std::optional<Interval> Spectrum::condition() const {
  if (!positive_definite()) return std::nullopt;
  return Interval{largest.lower / smallest.upper, largest.upper / smallest.lower};
}

Spectrum bound_spectrum(const BlockMatrix& a, double relative_width) {
  if (a.rows() == 0) return {};
  return Bounds(a, relative_width).find();
}

void Spectrum::report(config::Figures& f) const {
  const auto bounds = [&f](std::string_view key, const std::optional<Interval>& interval,
                           std::string_view help) {
    f.value(key,
            interval ? config::FigureValue(std::vector{interval->lower, interval->upper})
                     : config::FigureValue(),
            {}, help);
  };
  bounds("smallest", smallest, "two bounds of the smallest eigenvalue");
  bounds("largest", largest, "two bounds of the largest");
  bounds("condition", condition(),
         "two bounds of κ; null where the matrix is not proved positive definite");
}

}  // namespace hvp::sparse
