#include "models/plant/energy.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "models/plant/linear_axis.h"

namespace hvp::plant {

namespace {

// Gauss-Legendre on [0, 1]. What is integrated changes at twice the motion's rate; both leave out
// less than 1e-15 of it, the shorter one where rate·seconds is at most kSlow.
constexpr double kSlow = 0.5;
template <std::size_t Count>
struct Quadrature {
  std::array<double, Count> at;
  std::array<double, Count> weight;
};
constexpr Quadrature<6> kShort{
    {0.0337652428984239861, 0.1693953067668677432, 0.3806904069584015457, 0.6193095930415984543,
     0.8306046932331322568, 0.9662347571015760139},
    {0.0856622461895851725, 0.1803807865240693038, 0.2339569672863455237, 0.2339569672863455237,
     0.1803807865240693038, 0.0856622461895851725}};
constexpr Quadrature<10> kLong{
    {0.0130467357414141400, 0.0674683166555077446, 0.1602952158504877969, 0.2833023029353764046,
     0.4255628305091843946, 0.5744371694908156054, 0.7166976970646235954, 0.8397047841495122031,
     0.9325316833444922554, 0.9869532642585858600},
    {0.0333356721543440688, 0.0747256745752902966, 0.1095431812579910220, 0.1346333596549981775,
     0.1477621123573764351, 0.1477621123573764351, 0.1346333596549981775, 0.1095431812579910220,
     0.0747256745752902966, 0.0333356721543440688}};

// W.
struct Power {
  double motor;
  double intention;
  double device_damping;
  double hand_damping;
};

Power power(const LinearAxis& axis, const LinearAxis::State& s, double intended, double speed) {
  const double pulled = speed - s.hand_v;
  const double slipped = axis.grip_is_rigid() ? 0 : s.hand_v - s.handle_v;
  const double bent = s.handle_v - s.v;
  const double hand = axis.hand_stiffness * (intended - s.hand_x) + axis.hand_damping * pulled;
  return {s.force * s.v, hand * speed,
          axis.damping * s.v * s.v + axis.structure_damping * bent * bent,
          axis.hand_damping * pulled * pulled + axis.grip_damping * slipped * slipped};
}

template <std::size_t Count>
Energy integrated(const Quadrature<Count>& nodes, const LinearAxis& axis, double seconds,
                  const AxisSeries& series, double step, const LinearAxis::Drive& drive) {
  std::array<double, Count> shares = nodes.at;
  for (double& share : shares) share *= seconds / step;
  const std::array<LinearAxis::State, Count> states = series.at(shares);
  Energy sum;
  for (std::size_t i = 0; i < Count; ++i) {
    const double t = nodes.at[i] * seconds;
    const Power p = power(axis, states[i], value(drive.intended, t), slope(drive.intended, t));
    const double part = nodes.weight[i] * seconds;
    sum.by_motors += part * p.motor;
    sum.by_intention += part * p.intention;
    sum.device_damping += part * p.device_damping;
    sum.hand_damping += part * p.hand_damping;
  }
  return sum;
}

}  // namespace

Energy& Energy::operator+=(const Energy& other) {
  at_start += other.at_start;
  kinetic += other.kinetic;
  springs += other.springs;
  by_motors += other.by_motors;
  by_intention += other.by_intention;
  by_gravity += other.by_gravity;
  by_push += other.by_push;
  device_damping += other.device_damping;
  hand_damping += other.hand_damping;
  friction += other.friction;
  let_go += other.let_go;
  return *this;
}

double Energy::imbalance() const {
  const double lost = device_damping + hand_damping + friction + let_go;
  const double done = by_motors + by_intention + by_gravity + by_push;
  return kinetic + springs - at_start - done + lost;
}

double Energy::moved() const {
  return std::abs(at_start) + kinetic + springs + std::abs(by_motors) + std::abs(by_intention) +
         std::abs(by_gravity) + std::abs(by_push) + device_damping + hand_damping + friction +
         std::abs(let_go);
}

Energy work(const LinearAxis& axis, double seconds, const AxisSeries& series, double step,
            const LinearAxis::Drive& drive) {
  const bool slow = axis.rate() * seconds <= kSlow;
  return slow ? integrated(kShort, axis, seconds, series, step, drive)
              : integrated(kLong, axis, seconds, series, step, drive);
}

}  // namespace hvp::plant
