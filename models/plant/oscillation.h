#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

namespace hvp::plant {

// The motion of a tip in windows of one length, while the user who moves the device rests. Each
// window but the first is compared with those before. A motion that reverses by no more than kFelt
// does not count as a turn.
class Oscillation {
 public:
  static constexpr double kWindowSeconds = 0.25;
  static constexpr int kWindowFrames = 32;
  // A window that is not smaller than this part of the last one does not settle.
  static constexpr double kSettles = 0.99;
  static constexpr double kGrows = 1.02;
  static constexpr int kTurns = 3;
  // The mean of a swing stays, that of a drift goes half its way within a window: this part of the
  // motion, peak to peak, divides them.
  static constexpr double kDrifts = 0.4;
  // Smallest vibration that skin feels, 0.1 um peak at 250 Hz (Verrillo, J. Acoust. Soc. Am. 35,
  // 1963).
  static constexpr double kFelt = 0.2e-6;  // m, peak to peak

  struct Cycle {
    double amplitude_m = 0;  // half of peak to peak, along the worst axis
    double frequency_hz = 0;
    bool grows = false;
    std::int64_t frame = -1;  // the last frame of its window
  };

  // A whole window, along the axis that moves most.
  struct Window {
    double moves_m = 0;  // peak to peak
    double seconds = 0;
    bool swings = false;     // turned kTurns times at least, and its mean stays
    bool compared = false;   // there was a window before it
    bool unsettled = false;  // as large as the one before, and felt
  };

  explicit Oscillation(double window_s = kWindowSeconds) : window_s_(window_s) {}

  // Adds a frame; frames come in their order. `rests`: the intended motion rests. Returns true if
  // the frame ends a window.
  bool add(std::int64_t frame, double time_s, const Eigen::Vector3d& position, bool rests);

  // The largest oscillation that was found in any rest: windows that are not smaller than the one
  // before, that turn kTurns times and move by more than kFelt. Empty where none lasts.
  const std::optional<Cycle>& cycle() const { return worst_; }
  // The last whole window of the present rest; empty where there is none.
  const std::optional<Window>& last() const { return last_; }
  // Peak to peak since the last whole window of the present rest began, m.
  double moves_at_end() const;

 private:
  struct Extent {
    double began_s = 0;
    double ended_s = 0;
    std::int64_t frames = 0;
    Eigen::Vector3d least = Eigen::Vector3d::Zero();
    Eigen::Vector3d most = Eigen::Vector3d::Zero();
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();  // the farthest place since the last turn
    Eigen::Vector3d heading =
        Eigen::Vector3d::Zero();  // signs of the motion since then; 0: none yet
    Eigen::Array3i turns = Eigen::Array3i::Zero();
    // Sums of the positions from the first one in the window's first and second half.
    std::array<Eigen::Vector3d, 2> sums = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    std::array<std::int64_t, 2> counts{};
  };
  void begin(double time_s, const Eigen::Vector3d& position);
  void close(std::int64_t frame);

  double window_s_;
  Extent window_;
  Eigen::Vector3d from_ = Eigen::Vector3d::Zero();  // the window's first position
  std::optional<Eigen::Vector3d> before_;           // peak to peak of the window before
  std::optional<Window> last_;
  Extent closed_;  // of the last whole window
  std::optional<Cycle> worst_;
};

// Whether a device comes to rest while its user rests, by the size of its motion at the end: a
// swing that gets smaller may end in one that lasts. Windows of three lengths see swings from 12, 5
// and 2 half turns a second on. A swing that lasts in any of them, in any rest, is a cycle. Of the
// rests that were long enough for two windows the worst counts, however calm a later one is.
class RestWatch {
 public:
  enum class Verdict {
    not_measured,   // no rest was long enough to tell
    comes_to_rest,  // the motion is over
    swings,         // a swing lasts
    moves_on        // it flies or drifts away
  };
  // Peak to peak, m: what moves less for kStillSeconds, or in a shorter rest for half of it, and
  // for a quarter of a second at least, is at rest, unless it swings. Skin feels some 20 um at the
  // few hertz of a swing that turns too seldom to be one here (Verrillo 1963); five times that, for
  // hands and drives that creep.
  static constexpr double kStill = 1e-4;
  static constexpr double kStillSeconds = 0.5;

  void add(std::int64_t frame, double time_s, const Eigen::Vector3d& position, bool rests);

  Verdict verdict() const;
  // True if any rest was long enough for two of the shortest windows.
  bool compared() const { return worst().has_value(); }
  // The oscillation that lasts: that of the shortest windows which have one.
  const std::optional<Oscillation::Cycle>& cycle() const;
  // With Verdict::moves_on the distance that the last window moved over its length, m/s.
  std::optional<double> moves_on() const;
  // Peak to peak at the end of the rest that verdict() is of, m: in its last quarter to half of a
  // second. Empty where no rest was long enough.
  std::optional<double> last_moves_m() const;

 private:
  struct Judged {
    Verdict verdict = Verdict::not_measured;
    std::optional<double> speed;
    double moves_m = 0;
  };
  // The present rest, where it can be judged.
  std::optional<Judged> present() const;
  // The worst of all rests so far.
  std::optional<Judged> worst() const;

  std::array<Oscillation, 3> windows_ = {Oscillation(), Oscillation(0.6), Oscillation(1.5)};
  // The place within which the tip has been since `since_s`: no larger than kStill.
  struct Quiet {
    double since_s = 0;
    Eigen::Vector3d least = Eigen::Vector3d::Zero();
    Eigen::Vector3d most = Eigen::Vector3d::Zero();
  };
  bool still() const;

  bool resting_ = false;
  double rest_began_s_ = 0;
  double now_s_ = 0;
  Quiet quiet_;
  std::optional<Judged> before_;  // the worst of the rests that are over
};

}  // namespace hvp::plant
