#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace hvp::plant {

// Finds the oscillation that a motion ends in, while whoever moves the device rests: windows of
// kWindowSeconds one after the other, of which each but the first is compared with the one before.
// A window that is not smaller than kSettles of the last one, turns at least kTurns times and moves
// by more than kFelt is a limit cycle; one that grows by more than kGrows is divergence. One that
// turns less often moves on: a device that flies or drifts away, or swings slower than 6 Hz
// (which a detector of longer windows finds). What
// turns back by no more than kFelt has not turned.
class Oscillation {
 public:
  static constexpr double kWindowSeconds = 0.25;
  static constexpr int kWindowFrames = 32;
  static constexpr double kSettles = 0.99;
  static constexpr double kGrows = 1.02;
  static constexpr int kTurns = 3;
  // Smallest vibration that skin feels, 0.1 µm peak at 250 Hz (Verrillo, J. Acoust. Soc. Am. 35,
  // 1963).
  static constexpr double kFelt = 0.2e-6;  // m, peak to peak

  struct Cycle {
    double amplitude_m = 0;  // half of peak to peak, of the worst axis
    double frequency_hz = 0;
    bool grows = false;
    std::int64_t frame = -1;  // with which its window ended
  };

  explicit Oscillation(double window_s = kWindowSeconds) : window_s_(window_s) {}

  // Frames in their order. `rests`: the intended motion does.
  void add(std::int64_t frame, double time_s, const Eigen::Vector3d& position, bool rests);

  // The largest that was found; none where nothing swings on, or nothing ever rested long enough.
  const std::optional<Cycle>& cycle() const { return worst_; }
  // How far the last window moved over how long it was, m/s; none where it settled or swung.
  const std::optional<double>& moves_on() const { return moves_on_; }
  // Two windows at least could be compared.
  bool measured() const { return measured_; }

 private:
  struct Window {
    double began_s = 0;
    double ended_s = 0;
    std::int64_t frames = 0;
    Eigen::Vector3d least = Eigen::Vector3d::Zero();
    Eigen::Vector3d most = Eigen::Vector3d::Zero();
    Eigen::Vector3d turned = Eigen::Vector3d::Zero();   // the farthest since the last turn
    Eigen::Vector3d heading = Eigen::Vector3d::Zero();  // signs since then; 0: has not moved yet
    Eigen::Array3i turns = Eigen::Array3i::Zero();
  };
  void begin(double time_s, const Eigen::Vector3d& position);
  void close(std::int64_t frame);

  double window_s_;
  Window window_;
  std::optional<Eigen::Vector3d> before_;  // peak to peak of the window before
  std::optional<Cycle> worst_;
  std::optional<double> moves_on_;
  bool measured_ = false;
};

}  // namespace hvp::plant
