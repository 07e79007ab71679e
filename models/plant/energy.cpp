#include "models/plant/energy.h"

#include <array>
#include <cmath>
#include <span>

#include "models/plant/axis_series.h"

namespace hvp::plant {

namespace {

struct Node {
  double at;
  double weight;
};

// Gauss-Legendre on [0, 1]. What is integrated changes at twice the motion's rate; both leave out
// less than 1e-15 of it, the shorter one where rate·step is at most kSlow.
constexpr double kSlow = 0.5;
constexpr std::array<Node, 6> kShort = {{{0.0337652428984239861, 0.0856622461895851725},
                                         {0.1693953067668677432, 0.1803807865240693038},
                                         {0.3806904069584015457, 0.2339569672863455237},
                                         {0.6193095930415984543, 0.2339569672863455237},
                                         {0.8306046932331322568, 0.1803807865240693038},
                                         {0.9662347571015760139, 0.0856622461895851725}}};
constexpr std::array<Node, 10> kLong = {{{0.0130467357414141400, 0.0333356721543440688},
                                         {0.0674683166555077446, 0.0747256745752902966},
                                         {0.1602952158504877969, 0.1095431812579910220},
                                         {0.2833023029353764046, 0.1346333596549981775},
                                         {0.4255628305091843946, 0.1477621123573764351},
                                         {0.5744371694908156054, 0.1477621123573764351},
                                         {0.7166976970646235954, 0.1346333596549981775},
                                         {0.8397047841495122031, 0.1095431812579910220},
                                         {0.9325316833444922554, 0.0747256745752902966},
                                         {0.9869532642585858600, 0.0333356721543440688}}};

// W.
struct Power {
  double motor;
  double intention;
  double device_damping;
  double hand_damping;
};

Power power(const LinearAxis& axis, const LinearAxis::State& s, double intended, double speed) {
  const double pulled = speed - s.hand_v;
  const double slipped = axis.grip_is_rigid() ? 0 : s.hand_v - s.v;
  const double hand = axis.hand_stiffness * (intended - s.hand_x) + axis.hand_damping * pulled;
  return {s.force * s.v, hand * speed, axis.damping * s.v * s.v,
          axis.hand_damping * pulled * pulled + axis.grip_damping * slipped * slipped};
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

Energy work(const LinearAxis& axis, double seconds, const LinearAxis::State& from,
            const LinearAxis::Drive& drive) {
  Energy sum;
  walk(axis, seconds, from, drive, [&](const AxisSeries& series, double before, double step) {
    const bool slow = axis.rate() * step <= kSlow;
    const std::span<const Node> nodes = slow ? std::span<const Node>(kShort) : kLong;
    for (const Node& node : nodes) {
      const double t = before + node.at * step;
      const Power p =
          power(axis, series.at(node.at), value(drive.intended, t), slope(drive.intended, t));
      const double seconds_here = node.weight * step;
      sum.by_motors += seconds_here * p.motor;
      sum.by_intention += seconds_here * p.intention;
      sum.device_damping += seconds_here * p.device_damping;
      sum.hand_damping += seconds_here * p.hand_damping;
    }
    return true;
  });
  return sum;
}

}  // namespace hvp::plant
