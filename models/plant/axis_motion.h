#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "models/plant/energy.h"
#include "models/plant/linear_axis.h"
#include "models/plant/plant.h"

namespace hvp::plant {

// The motion of an axis with dry friction over a stretch of time, in pieces over which it is
// linear: it slips one way, or it sticks. The pieces are found once; all queries afterwards are
// functions of them and of the time alone.
//
// Slipping ends at the first root of the velocity, sticking at the first time at which the other
// forces are larger than Friction::hold(), both to the last bit. Rounding in a sum of forces does
// not loosen the axis.
class AxisMotion {
 public:
  // Finds the pieces from `state` on. Returns the time for which they are valid, s: `seconds`, or
  // less where it takes more than kMostPieces.
  double begin(const LinearAxis& axis, const std::optional<Friction>& friction,
               const LinearAxis::State& state, const LinearAxis::Drive& drive, double seconds);

  // State, drive and energy at a time after that of begin(), s.
  LinearAxis::State at(double seconds) const;
  LinearAxis::Drive drive_at(double seconds) const;
  // The energy that flowed until then, without gravity and push, which are not told apart here.
  Energy flowed(double seconds) const;

 private:
  static constexpr std::size_t kMostPieces = 8;

  struct Piece {
    Piece(const LinearAxis& axis, double starts, double lasts, const LinearAxis::State& from,
          const LinearAxis::Drive& driven, double slips, double rubs);

    double start;  // s
    double step;   // s
    LinearAxis::State state;
    LinearAxis::Drive drive;  // with the friction
    double direction;         // of slipping, 1 or −1; 0 where it sticks or has no friction
    double friction;          // N, signed
    AxisSeries series;        // over `step`
  };

  // The piece that follows from a state; each adds one.
  void decide(double start, const LinearAxis::State& state, const LinearAxis::Drive& drive);
  void stick(double start, const LinearAxis::State& state, const LinearAxis::Drive& drive);
  // Adds a piece that slips in that direction or, without friction, moves.
  void slip(double start, const LinearAxis::State& state, const LinearAxis::Drive& drive,
            double direction);
  void add(double start, const LinearAxis::State& state, const LinearAxis::Drive& drive,
           double direction, double friction);
  // The time at which it stops slipping or breaks loose, and the direction.
  std::optional<AxisSeries::Change> change_in(const Piece& piece) const;
  LinearAxis::State state_in(const Piece& piece, double seconds) const;
  const Piece& last() const { return *pieces_[count_ - 1]; }
  const Piece& piece_at(double seconds) const;

  LinearAxis axis_;
  std::optional<Friction> friction_;
  double length_ = 0;  // s
  std::array<std::optional<Piece>, kMostPieces> pieces_;
  std::size_t count_ = 0;
};

}  // namespace hvp::plant
