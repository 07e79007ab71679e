#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include <ceres/jet.h>

#include "models/fit/qlv_problem.h"

namespace hvp::fit {

// Quasi-linear viscoelasticity (Fung, Biomechanics, 2nd ed. 1993, §7.6): a force is the sum of what
// remains at a time t of the elastic steps before it,
//   F(t) = ∫ G(t − s)·dF_e(δ(s)),   G(t) = 1 − Σgᵢ + Σ gᵢ·e^(−t/τᵢ),
// with δ the depth behind the contact. Between two samples the travel is a straight line, and the
// integral over such a piece is exact to rounding. The scalar is double or ceres::Jet.

// The loaded part of a piece: its depths behind the contact (m) at its beginning and end, and its
// length (s).
template <class T>
struct LoadedPiece {
  T from;
  T to;
  T seconds;
};

// (e^z − 1)/z, 1 at zero.
template <class T>
T mean_exponential(const T& z) {
  using std::exp;
  // The series' truncation error is less than 1e-17 of its sum.
  constexpr double kNear = 0.5;
  constexpr int kTerms = 13;
  if (z > kNear || z < -kNear) return (exp(z) - 1.0) / z;
  T sum(1.0);
  for (int n = kTerms; n > 1; --n) sum = sum * z / static_cast<double>(n) + 1.0;
  return sum;
}

// F_e = c·(e^(qδ) − 1)/q.
template <class T>
struct FungElasticity {
  T c;  // N/m
  T q;  // 1/m

  T force(const T& depth) const { return c * depth * mean_exponential<T>(q * depth); }

  // ∫ e^(−(t − s)/τ) dF_e over a piece that ends at t. With dF_e = c·e^(qδ)·δ' the exponent is
  // linear in time. Its slope q·δ' + 1/τ is zero where unloading is as fast as relaxation, and the
  // form that does not overflow is taken on either side.
  T remaining(const LoadedPiece<T>& piece, const T& tau) const {
    using std::exp;
    const T moved = piece.to - piece.from;
    const T decay = piece.seconds / tau;
    const T z = q * moved + decay;
    if (z > 0.0) return c * moved * exp(q * piece.to) * mean_exponential<T>(-z);
    return c * moved * exp(q * piece.from - decay) * mean_exponential<T>(z);
  }
};

// F_e = c·δⁿ, n ≥ 1.
template <class T>
struct PowerElasticity {
  T c;  // N/mⁿ
  T n;

  T force(const T& depth) const {
    using std::pow;
    return depth > 0.0 ? T(c * pow(depth, n)) : T(0.0);
  }

  // The same integral. δⁿ⁻¹ has a branch point at the contact. Near it the integral from there is a
  // series whose terms are all positive (Kummer's function, DLMF 13.2.2 and 13.2.39), summed until
  // they are below 1e-17 of it; elsewhere Gauss' rule with eight points is right to 1e-12.
  T remaining(const LoadedPiece<T>& piece, const T& tau) const {
    using std::exp;
    const T decay = piece.seconds / tau;
    if (piece.to > piece.from) {
      if (2.0 * piece.from > piece.to) return quadrature(piece, decay);
      const T rate = decay / (piece.to - piece.from);
      return loaded(piece.to, rate) - exp(-decay) * loaded(piece.from, rate);
    }
    if (2.0 * piece.to > piece.from) return quadrature(piece, decay);
    const T rate = decay / (piece.from - piece.to);
    return exp(piece.to * rate) * (unloaded(piece.to, rate) - unloaded(piece.from, rate));
  }

 private:
  static constexpr int kMostTerms = 1000;
  static constexpr double kSmall = 1e-17;

  // ∫₀^δ e^(−(δ − y)·rate)·c·n·yⁿ⁻¹ dy = c·δⁿ·e^(−a)·Σ aᵏ/k!·n/(n + k), a = rate·δ.
  T loaded(const T& depth, const T& rate) const {
    using std::exp;
    if (!(depth > 0.0)) return T(0.0);
    const T a = rate * depth;
    T power(1.0);
    T sum(1.0);
    for (int k = 1; k < kMostTerms; ++k) {
      power *= a / static_cast<double>(k);
      const T term = power * n / (n + static_cast<double>(k));
      sum += term;
      if (term < kSmall * sum) break;
    }
    return force(depth) * exp(-a) * sum;
  }

  // ∫₀^δ e^(−y·rate)·c·n·yⁿ⁻¹ dy = c·δⁿ·e^(−a)·Σ aᵏ/((n + 1)…(n + k)).
  T unloaded(const T& depth, const T& rate) const {
    using std::exp;
    if (!(depth > 0.0)) return T(0.0);
    const T a = rate * depth;
    T term(1.0);
    T sum(1.0);
    for (int k = 1; k < kMostTerms; ++k) {
      term *= a / (n + static_cast<double>(k));
      sum += term;
      if (term < kSmall * sum) break;
    }
    return force(depth) * exp(-a) * sum;
  }

  T quadrature(const LoadedPiece<T>& piece, const T& decay) const {
    using std::exp;
    using std::pow;
    // Abramowitz & Stegun, table 25.4, on [−1, 1].
    constexpr std::array<double, 4> kPlaces{0.183434642495650, 0.525532409916329, 0.796666477413627,
                                            0.960289856497536};
    constexpr std::array<double, 4> kWeights{0.362683783378362, 0.313706645877887,
                                             0.222381034453374, 0.101228536290376};
    const T moved = piece.to - piece.from;
    T sum(0.0);
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
      for (const double place : {kPlaces[i], -kPlaces[i]}) {
        const double share = 0.5 * (1 + place);
        const T depth = piece.from + share * moved;
        sum += 0.5 * kWeights[i] * pow(depth, n - 1.0) * exp((share - 1) * decay);
      }
    }
    return c * n * moved * sum;
  }
};

// One exponential of G.
template <class T>
struct Relaxation {
  T share;  // g
  T tau;    // s
};

// The loaded part of a piece of travel from depth `from` to `to` behind the contact (negative
// before it), and in `after` the unloaded time that follows it.
template <class T>
LoadedPiece<T> loaded_part(const T& from, const T& to, double seconds, T& after) {
  after = T(0.0);
  if (from > 0.0 && to > 0.0) return {from, to, T(seconds)};
  if (to > 0.0) return {T(0.0), to, seconds * to / (to - from)};
  after = seconds * to / (to - from);
  return {from, T(0.0), seconds - after};
}

// Writes the force (N) at each sample to `out`. `contact` (m) is measured as PressedLog::depth,
// `offset` is in N. The model assumes that any load at the first sample has relaxed.
template <class T, class Elasticity, std::size_t Count>
void qlv_response(const PressedLog& log, const Elasticity& elasticity,
                  const std::array<Relaxation<T>, Count>& relaxation, const T& contact,
                  const T& offset, T* out) {
  using std::exp;
  T left(1.0);  // G at infinity
  for (const Relaxation<T>& r : relaxation) left -= r.share;
  std::array<T, Count> held{};
  held.fill(T(0.0));
  std::array<T, Count> decay{};
  decay.fill(T(1.0));
  double decay_of = 0;  // s

  T before = log.depth[0] - contact;
  for (std::size_t i = 0; i < log.time.size(); ++i) {
    const T depth = log.depth[i] - contact;
    if (i > 0) {
      const double seconds = log.time[i] - log.time[i - 1];
      if (seconds != decay_of) {
        for (std::size_t j = 0; j < Count; ++j) decay[j] = exp(-seconds / relaxation[j].tau);
        decay_of = seconds;
      }
      for (std::size_t j = 0; j < Count; ++j) held[j] *= decay[j];
      const bool loaded = depth > 0.0 || before > 0.0;
      if (loaded && log.depth[i] != log.depth[i - 1]) {
        T after;
        const LoadedPiece<T> piece = loaded_part<T>(before, depth, seconds, after);
        for (std::size_t j = 0; j < Count; ++j) {
          T remaining = elasticity.remaining(piece, relaxation[j].tau);
          if (after > 0.0) remaining *= exp(-after / relaxation[j].tau);
          held[j] += remaining;
        }
      }
    }
    out[i] = offset;
    if (depth > 0.0) out[i] += left * elasticity.force(depth);
    for (std::size_t j = 0; j < Count; ++j) out[i] += relaxation[j].share * held[j];
    before = depth;
  }
}

}  // namespace hvp::fit
