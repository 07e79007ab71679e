#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "models/config/figures.h"
#include "models/stability/flag.h"

namespace hvp::stability {

// One frame's force, as the user who grips the device feels it.
struct FeltForce {
  std::int64_t frame = 0;
  double time_s = 0;                                // time of the frame's birth
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    // as read, m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on the body, N
  int contact = -1;                                 // node, −1: none
  bool fades = false;                               // forces of released nodes still act
  // The component of the force along the surface's outward normal at rest, N: positive where the
  // tip pulls at the body, which no tip can.
  double pull = 0;
  // The point of the body's surface at rest that is nearest to the tip, m, where contact glides:
  // what the tip presses is its way from there. Absent: from where the contact began.
  std::optional<Eigen::Vector3d> foot = {};
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of the surface where it glides
};

// A figure and its frame; −1 where there is none.
struct WorstFrame {
  double value = 0;
  std::int64_t frame = -1;
};

// The quality of a run's force, whatever its accuracy. No other data of a run are kept, so that
// memory does not grow with it.
//
// A step is |F(n) − F(n−1)|. People distinguish forces that differ by some 7 % (Jones, Perception
// 18, 1989; Pang, Tan & Durlach, Percept. Psychophys. 49, 1991); a step beyond kLargestStep of the
// run's largest force raises the flag `force-step`.
//
// A hand-over from node to node may spread its step over many frames. While a contact lasts and has
// been handed over within 2·w, the second difference F(t) − 2·F(t−w) + F(t−2w) is the change that
// the trend before does not explain; what the tip's own motion explains of it, |F|·|Δ²d|/|d| with
// d = x − x_0 and x_0 the place of the first touch or the foot, is taken off. Beyond kNoticeable of
// the largest of the three forces, for w of 30 or of 100 ms, it raises `force-step` too. Of a
// contact that glides the change is that of the force along the normal: its friction turns, comes
// and goes with the tip's motion, and is bound to what presses.
//
// An alternation is a frame whose change is opposite to that of the frame before, as that one was
// to its own predecessor. Alternations whose three changes exceed kRingingShare of the largest
// force, more than kMostAlternations in a window of kWindowSeconds (or kWindowFrames frames, where
// those take longer), raise the flag `force-ringing`: no hand does that.
//
// While the tip, as read, and the contact node rest, the force must come to rest too. The rest is
// divided into windows of kRestSeconds, and each but the first is compared with the one before. A
// force that moves by more than kRipple of itself, peak to peak, and by more than kSettles of its
// motion in the window before, does not settle and raises the flag `limit-cycle`. A body of the
// default material swings at some 9 Hz with 3 % of critical damping (docs/finite-elements.md): by
// itself it loses a quarter in that time.
class ForceQuality {
 public:
  static constexpr double kLargestStep = 0.10;
  static constexpr double kNoticeable = 0.10;
  static constexpr std::array<double, 2> kSpans = {0.03, 0.1};  // w, s
  static constexpr double kRingingShare = 0.02;
  static constexpr int kMostAlternations = 8;
  static constexpr double kWindowSeconds = 0.1;
  static constexpr int kWindowFrames = 32;
  static constexpr double kRestSeconds = 0.18;
  static constexpr double kSettles = 0.8;
  static constexpr double kRipple = 0.015;
  // Smaller forces than this count as none, N: it is a hundredth of the friction of devices of this
  // kind (0.04 N for a Premium 1.5, data sheet).
  static constexpr double kNoForce = 4e-4;

  // Adds a frame; frames come in their order.
  void add(const FeltForce& felt);

  WorstFrame peak() const { return peak_; }  // |F|, N
  WorstFrame step() const { return step_; }  // N
  double step_share() const;                 // share of the peak; 0 without a force
  // The change around a hand-over over kSpans[i], as a share of the force; the frame is the last of
  // the span.
  WorstFrame handed_over(std::size_t i) const { return handed_over_[i]; }
  WorstFrame pull() const { return pull_; }  // N
  // The largest number of alternations in a window, with changes beyond kRingingShare of the peak.
  std::int64_t alternations() const;
  // The largest ripple of the windows that did not settle: peak to peak, as a share of the window's
  // mean force. Empty where the tip never rested long enough.
  std::optional<double> ripple() const;

  Flags flags() const;
  void report(config::Figures& f) const;

 private:
  // Counts of alternations by the smallest of their changes, in kBinsAnOctave bins for each factor
  // of two.
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

  // A force and a place to look back to.
  struct Past {
    double time_s = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  // where contact glides, along the normal
    double size = 0;                                  // of the whole force
    Eigen::Vector3d way = Eigen::Vector3d::Zero();    // tip, or tip − foot
  };
  static constexpr std::size_t kPasts = 64;
  // They cover twice the longest span.
  static constexpr double kPastSeconds = 2 * kSpans.back() / (kPasts - 2);

  static int bin(double change);
  void watch_hand_over(const FeltForce& felt);
  // The latest past of at least that age; null where none is kept.
  const Past* past(double time_s) const;
  void count_alternation(const FeltForce& felt, const Eigen::Vector3d& change);
  void close_alternations();
  void watch_rest(const FeltForce& felt);
  void close_rest_window();

  FeltForce last_;
  bool any_ = false;
  Eigen::Vector3d last_change_ = Eigen::Vector3d::Zero();
  WorstFrame peak_, step_, pull_, ripple_;
  double last_turned_ = 0;  // the smaller change of a turn in the last frame, N; 0: no turn
  bool rested_ = false;

  std::array<Past, kPasts> pasts_;  // a ring
  std::size_t kept_ = 0;            // of all times
  std::optional<Past> touched_;     // the first frame of the present contact
  double handed_over_s_ = -1;       // when it was handed over last; −1: it has not been
  std::array<WorstFrame, kSpans.size()> handed_over_;

  double alternations_began_s_ = 0;
  std::int64_t alternations_frames_ = 0;
  Bins alternations_{};       // in the present window
  Bins most_alternations_{};  // the most in any window, with at least that change

  Window rest_;
  std::optional<double> ripple_before_;  // of the window before
};

}  // namespace hvp::stability
