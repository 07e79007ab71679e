#include "models/plant/output_stage_parts.h"

#include <algorithm>
#include <cmath>

namespace hvp::plant {

double BipolarConverter::step() const { return std::ldexp(range_V, 1 - bits); }

double BipolarConverter::largest() const { return range_V - step(); }

BipolarConverter::Voltage BipolarConverter::nearest(double volts) const {
  if (std::isnan(volts)) return {.volts = 0, .saturated = true};
  const double most = std::ldexp(1.0, bits - 1) - 1;
  const double steps = std::round(volts / step());
  return {.volts = std::clamp(steps, -most, most) * step(), .saturated = std::abs(steps) > most};
}

void BipolarConverter::declare(config::Visitor& v, std::string_view source) {
  v.integer("bits", bits, {2, 32},
            {.help = "of the converter, its sign included", .source = source});
  v.quantity("range", range_V, config::Dimension::voltage, config::between(1e-3, 1e3),
             {.help = "from zero to its full scale, both ways", .source = source});
}

void Dac::declare(config::Visitor& v) {
  BipolarConverter::declare(v, "Quanser Q4: 12 bits, +-10 V");
}

void Adc::declare(config::Visitor& v) {
  BipolarConverter::declare(v, "Quanser Q4: 14 bits, +-10 V");
  v.quantity("sense", sense_A_V, config::Dimension::transconductance, config::between(1e-6, 1e6),
             {.help = "what a volt of the amplifier's current sense stands for",
              .source = "Quanser linear current amplifier: 2 A/V"});
}

void Amplifier::declare(config::Visitor& v) {
  v.quantity("gain", gain_A_V, config::Dimension::transconductance, config::between(1e-6, 1e6),
             {.help = "current for a volt of its command",
              .source = "Quanser linear current amplifier: 0.5 A/V"});
  v.quantity(
      "current_limit", current_limit_A, config::Dimension::current, config::between(1e-6, 1e6),
      {.help = "largest current, both ways", .source = "Quanser linear current amplifier: 2.4 A"});
  v.quantity("bandwidth", bandwidth_Hz, config::Dimension::frequency, config::between(0, 1e6),
             {.help = "of its first-order lag; 0 Hz: the current is there at once",
              .source = "0 Hz: Quanser publishes none"});
}

void Motor::declare(config::Visitor& v) {
  v.quantity("torque_constant", torque_constant_N_m_A, config::Dimension::torque_constant,
             config::between(1e-6, 1e3),
             {.help = "torque of the motor for its current",
              .source = "maxon RE 25 118743, the motor of a PHANToM Premium (mahilab/Phantom)"});
  v.vector("transmission", transmission, config::Dimension::dimensionless,
           config::between(1e-3, 1e3),
           {.help = "turns of the motor in a turn of each joint",
            .source = "PHANToM Premium 1.5, capstan drives, as measured for its rebuild at Rice "
                      "University (mahilab/Phantom)"});
  v.quantity("lever", lever, config::Dimension::length, config::between(1e-4, 10),
             {.help = "where the device has no kinematics: the arm at which each joint's torque "
                      "makes the force along its axis",
              .source = "upper arm of a PHANToM Premium 1.5: Cavusoglu et al. 2001"});
}

}  // namespace hvp::plant
