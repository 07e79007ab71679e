#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

#include "models/config/declaration.h"
#include "models/tissue/operations.h"

namespace hvp::tissue {

// Quasi-linear viscoelasticity (Fung: Biomechanics, 2nd ed. 1993, §7.6) with a Prony series: of an
// elastic force f_e that steps at time 0 there is G(t) = g∞ + Σ gᵢ·e^(−t/τᵢ) of it left at t, with
// g∞ = 1 − Σgᵢ, and steps add up. f_e is the force of any law at once, without relaxation.

struct PronyTerm {
  double share = 0;   // gᵢ, of the force at once
  double time_s = 1;  // τᵢ

  void declare(config::Visitor& v);
};

// Throws InputError naming "prony[i].share" or "prony[i].time", and "prony" where the shares
// exceed one.
void check_prony(std::span<const PronyTerm> terms);

// The series for frames of one length, in which f_e changes evenly (Taylor, Pister, Goudreau:
// Thermomechanical analysis of viscoelastic solids, 1970):
//   hᵢ ← e^(−Δt/τᵢ)·hᵢ + cᵢ·Δf_e,  cᵢ = gᵢ·(1 − e^(−Δt/τᵢ))·τᵢ/Δt,  f = g∞·f_e + Σhᵢ.
// It is exact for forces that do change evenly, whatever Δt/τ.
class PronySeries {
 public:
  struct Step {
    double decay;  // e^(−Δt/τᵢ)
    double gain;   // cᵢ
  };

  // Throws InputError for what check_prony() refuses and for a step that is not above zero.
  PronySeries(std::span<const PronyTerm> terms, double step_s);

  const std::vector<Step>& steps() const { return steps_; }
  // g∞: of a force that is kept for ever.
  double remaining() const { return remaining_; }
  // g∞ + Σcᵢ: of a change of the elastic force within a frame its force has this share at the
  // frame's end. It multiplies K in the matrix of a frame, and is constant as K is.
  double stiffness_factor() const { return stiffness_factor_; }

 private:
  std::vector<Step> steps_;
  double remaining_ = 1;
  double stiffness_factor_ = 1;
};

// The memory of a body's forces, a number of them for each component and term.
//
// It is kept by nodes, not by elements. The recursion multiplies by numbers that are the same
// everywhere, and a node's force is a fixed sum over elements, V·P·g_a with V and g_a of the body
// at rest, so that the memory of the sum is the sum of the elements' memories. This holds for a
// linear K and for every law here; what is then relaxed is P in axes that are fixed in space. Where
// a part turns by θ within its times of relaxation, its memory keeps the old direction: an error of
// up to (1 − g∞)·2·sin(θ/2) of its force, which fades with the τᵢ. A memory that turns has to be
// kept by element, of RᵀP for the corotational law or of F⁻¹P for the others.
//
// A frame may ask for forces() as often as it likes; commit() ends it. A frame whose solve failed
// is committed with the elastic forces it ends with, those of the frame before if nothing moved, or
// not at all if its time is not to count. After construction nothing allocates. T is double; a test
// has a number that counts.
template <class T>
class PronyForces {
 public:
  // Of so many components, at rest and without load.
  PronyForces(const PronySeries& series, std::size_t components)
      : total_gain_(series.stiffness_factor()),
        change_gain_(series.stiffness_factor() - series.remaining()),
        elastic_(components, T(0)),
        history_(components, T(0)),
        memory_(components * series.steps().size(), T(0)) {
    for (const PronySeries::Step& step : series.steps()) {
      steps_.push_back({T(step.decay), T(step.gain)});
    }
  }

  // What a component takes.
  static constexpr Operations kForces = {.add_multiply = 2};
  static constexpr Operations commit_operations(std::size_t terms) {
    return {.add_multiply = 2 + 4 * static_cast<double>(terms)};
  }

  // Forgets every load: `elastic` has been there for ever.
  void rest(std::span<const T> elastic) {
    assert(elastic.size() == elastic_.size());
    std::copy(elastic.begin(), elastic.end(), elastic_.begin());
    std::fill(memory_.begin(), memory_.end(), T(0));
    for (std::size_t k = 0; k < elastic_.size(); ++k) history_[k] = -(change_gain_ * elastic_[k]);
  }

  // The forces (N) at the end of the present frame if the elastic ones are then these. They may be
  // the same span.
  Operations forces(std::span<const T> elastic, std::span<T> total) const {
    assert(elastic.size() == elastic_.size() && total.size() == elastic_.size());
    for (std::size_t k = 0; k < elastic.size(); ++k) {
      total[k] = total_gain_ * elastic[k] + history_[k];
    }
    return static_cast<double>(elastic.size()) * kForces;
  }

  // Ends the present frame with these elastic forces.
  Operations commit(std::span<const T> elastic) {
    assert(elastic.size() == elastic_.size());
    std::size_t next = 0;
    for (std::size_t k = 0; k < elastic.size(); ++k) {
      const T change = elastic[k] - elastic_[k];
      elastic_[k] = elastic[k];
      T history = -(change_gain_ * elastic[k]);
      for (const Step& step : steps_) {
        // As it will be at the end of the coming frame, but for what changes in it.
        T& memory = memory_[next++];
        memory = step.decay * (memory + step.gain * change);
        history = history + memory;
      }
      history_[k] = history;
    }
    return static_cast<double>(elastic.size()) * commit_operations(steps_.size());
  }

 private:
  struct Step {
    T decay;
    T gain;
  };

  T total_gain_;   // g∞ + Σcᵢ
  T change_gain_;  // Σcᵢ
  std::vector<Step> steps_;
  std::vector<T> elastic_;  // N, at the end of the last frame
  std::vector<T> history_;  // N, the forces of the present frame for elastic ones of zero
  std::vector<T> memory_;   // N, hᵢ decayed by a frame, a component's terms in a row
};

}  // namespace hvp::tissue
