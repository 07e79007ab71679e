#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "models/config/figures.h"
#include "models/stability/flag.h"

namespace hvp::stability {

// One frame's force, as whoever holds the device feels it.
struct FeltForce {
  std::int64_t frame = 0;
  double time_s = 0;                                // of the frame's birth
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    // as read, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on the body, N
  int contact = -1;                                 // node, −1: none
  bool fades = false;                               // forces of nodes let go still act
  // Component of the force along the surface's outward normal at rest, N: positive where the tip
  // pulls at the body, which no tip can.
  double pull = 0;
};

// A figure and the frame that it is of; −1 where there is none.
struct WorstFrame {
  double value = 0;
  std::int64_t frame = -1;
};

// What a run's force is like, whatever its accuracy. Nothing of a run is kept but this, so that
// memory does not grow with it.
//
// A step is |F(n) − F(n−1)|. People tell forces apart that differ by some 7 % (Jones, Perception
// 18, 1989; Pang, Tan & Durlach, Percept. Psychophys. 49, 1991); a step beyond kLargestStep of the
// run's largest force is flagged `force-step`.
//
// An alternation is a frame whose change is against that of the frame before, as that one was.
// Alternations whose three changes exceed kRingingShare of the largest force, more than
// kMostAlternations in a window of kWindowSeconds (or kWindowFrames frames, where those take
// longer), are flagged `force-ringing`: no hand does that.
//
// While the tip, as read, and the contact node rest, the force has to come to rest too. Of every
// window of kRestSeconds of the rest but the first, a force that moves by more than kRipple of
// itself, peak to peak, and by more than kSettles of what it moved in the window before, does not
// settle and is flagged `limit-cycle`. A body of the default material swings at some 9 Hz with 3 %
// of critical damping (docs/finite-elements.md): by itself it loses a quarter in that time.
class ForceQuality {
 public:
  static constexpr double kLargestStep = 0.10;
  static constexpr double kRingingShare = 0.02;
  static constexpr int kMostAlternations = 8;
  static constexpr double kWindowSeconds = 0.1;
  static constexpr int kWindowFrames = 32;
  static constexpr double kRestSeconds = 0.18;
  static constexpr double kSettles = 0.8;
  static constexpr double kRipple = 0.015;
  // Forces below this are no force, N: a hundredth of what devices of this kind exert as friction
  // (0.04 N for a Premium 1.5, data sheet).
  static constexpr double kNoForce = 4e-4;

  // Frames in their order.
  void add(const FeltForce& felt);

  WorstFrame peak() const { return peak_; }  // |F|, N
  WorstFrame step() const { return step_; }  // N
  double step_share() const;                 // of the peak; 0 without a force
  WorstFrame pull() const { return pull_; }  // N
  // The most in a window, of changes beyond kRingingShare of the peak.
  std::int64_t alternations() const;
  // Peak to peak, of the mean force of its window; the largest of those that did not settle. None
  // where the tip never rested long enough.
  std::optional<double> ripple() const;
  std::int64_t ripple_frame() const { return ripple_.frame; }

  Flags flags() const;
  void report(config::Figures& f) const;

 private:
  // Alternations by the smallest of their changes: kBinsAnOctave bins for each factor of two.
  static constexpr int kBinsAnOctave = 4;
  static constexpr int kOctaves = 40;  // from 1 nN on
  static constexpr int kBins = kBinsAnOctave * kOctaves;
  using Bins = std::array<std::int32_t, kBins>;

  struct Window {
    double began_s = 0;
    std::int64_t frames = 0;
    Eigen::Vector3d least = Eigen::Vector3d::Zero();
    Eigen::Vector3d most = Eigen::Vector3d::Zero();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  };

  static int bin(double change);
  void count_alternation(const FeltForce& felt, const Eigen::Vector3d& change);
  void close_alternations();
  void watch_rest(const FeltForce& felt);
  void close_rest_window();

  FeltForce last_;
  bool any_ = false;
  Eigen::Vector3d last_change_ = Eigen::Vector3d::Zero();
  WorstFrame peak_, step_, pull_, ripple_;
  double last_turned_ = 0;  // smaller change of a turn in the last frame, N; 0: it was none
  bool rested_ = false;

  double alternations_began_s_ = 0;
  std::int64_t alternations_frames_ = 0;
  Bins alternations_{};       // in the present window
  Bins most_alternations_{};  // with at least that change, the most of any window

  Window rest_;
  std::optional<double> ripple_before_;  // of the window before
};

}  // namespace hvp::stability
