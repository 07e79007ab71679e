#include "models/plant/polynomial.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace hvp::plant {

double value(const Polynomial& p, double t) {
  double sum = 0;
  for (std::size_t n = p.size(); n-- > 0;) sum = sum * t + p[n];
  return sum;
}

double slope(const Polynomial& p, double t) {
  double sum = 0;
  for (std::size_t n = p.size(); n-- > 1;) sum = sum * t + static_cast<double>(n) * p[n];
  return sum;
}

Polynomial shifted(const Polynomial& p, double seconds) {
  // Horner's scheme, repeated: Taylor coefficients about the new origin.
  Polynomial q = p;
  for (std::size_t i = 0; i + 1 < q.size(); ++i) {
    for (std::size_t n = q.size() - 1; n-- > i;) q[n] += seconds * q[n + 1];
  }
  return q;
}

namespace {

constexpr std::size_t kMost = 36;
constexpr int kDeepest = 60;  // halvings of the interval: below rounding

// The Bernstein coefficients of a polynomial over an interval. It lies between the smallest and the
// largest of them, and has at most as many roots within as they change their sign.
struct Bernstein {
  std::array<double, kMost> b;
  std::size_t count;

  int sign_changes() const {
    int changes = 0;
    double last = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (b[i] == 0) continue;
      if (last != 0 && (b[i] < 0) != (last < 0)) ++changes;
      last = b[i];
    }
    return changes;
  }

  // The coefficients of the first half; those of the second are left (de Casteljau).
  Bernstein split() {
    Bernstein first{b, count};
    for (std::size_t k = 0; k + 1 < count; ++k) {
      first.b[k] = b[0];
      for (std::size_t i = 0; i + 1 + k < count; ++i) b[i] = 0.5 * (b[i] + b[i + 1]);
    }
    first.b[count - 1] = b[0];
    return first;
  }
};

Bernstein to_bernstein(std::span<const double> a) {
  Bernstein p{{}, a.size()};
  const std::size_t degree = a.size() - 1;
  double binomial = 1;
  for (std::size_t k = 0; k <= degree; ++k) {
    p.b[k] = a[k] / binomial;
    binomial *= static_cast<double>(degree - k) / static_cast<double>(k + 1);
  }
  for (std::size_t k = 1; k <= degree; ++k) {
    for (std::size_t i = degree; i >= k; --i) p.b[i] += p.b[i - 1];
  }
  return p;
}

double at(std::span<const double> a, double s) {
  double sum = 0;
  for (std::size_t n = a.size(); n-- > 0;) sum = sum * s + a[n];
  return sum;
}

// The sign at `low` is that of `sign`; at the end found it is not.
double bisect(std::span<const double> a, double low, double high, double sign) {
  for (;;) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) return high;
    (at(a, middle) * sign > 0 ? low : high) = middle;
  }
}

std::optional<double> search(std::span<const double> a, Bernstein p, double low, double high,
                             double sign, int depth) {
  if (p.sign_changes() <= 1 || depth == kDeepest) {
    if (at(a, high) * sign > 0) return {};
    return bisect(a, low, high, sign);
  }
  const double middle = 0.5 * (low + high);
  const Bernstein first = p.split();
  if (const auto root = search(a, first, low, middle, sign, depth + 1)) return root;
  return search(a, p, middle, high, sign, depth + 1);
}

}  // namespace

std::optional<double> first_root(std::span<const double> coefficients) {
  std::span<const double> a = coefficients;
  while (!a.empty() && a.front() == 0) a = a.subspan(1);  // roots at 0 itself
  if (a.size() < 2) return {};
  double others = 0;
  for (const double c : a.subspan(1)) others += std::abs(c);
  if (std::abs(a.front()) > others) return {};
  return search(a, to_bernstein(a), 0, 1, a.front(), 0);
}

}  // namespace hvp::plant
