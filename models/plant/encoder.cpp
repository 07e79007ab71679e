#include "models/plant/encoder.h"

#include <cmath>
#include <numbers>

namespace hvp::plant {

std::int32_t wrapped(std::int64_t counts, int bits) {
  const int above = 64 - bits;
  const std::uint64_t shifted = static_cast<std::uint64_t>(counts) << above;
  return static_cast<std::int32_t>(static_cast<std::int64_t>(shifted) >> above);
}

void JointEncoder::declare(config::Visitor& v) {
  v.integer("counts_per_turn", counts_per_turn, {1, 100'000'000},
            {.help = "counts a turn of the motor, all four edges of a line counted",
             .source = "2048 lines, as Quanser fits them"});
  v.vector("gear", gear, config::Dimension::dimensionless, config::between(1e-3, 1e3),
           {.help = "turns of the motor in a turn of each joint",
            .source = "PHANToM Premium 1.5, capstan drives, as measured for its rebuild at Rice "
                      "University (mahilab/Phantom)"});
  v.integer("counter_bits", counter_bits, {1, 32},
            {.help = "width of the board's counters, which wrap around",
             .source = "Quanser Q4: 24 bits"});
}

Eigen::Vector3d JointEncoder::step() const {
  return 2 * std::numbers::pi / static_cast<double>(counts_per_turn) * gear.cwiseInverse();
}

std::optional<Eigen::Vector3d> JointEncoder::read(const Kinematics& kinematics,
                                                  const Eigen::Vector3d& tip, bool& wraps) const {
  std::optional<Eigen::Vector3d> q = kinematics.joints(tip);
  if (!q) return std::nullopt;
  const Eigen::Vector3d steps = step();
  for (int i = 0; i < 3; ++i) {
    const std::int64_t counts = std::llround((*q)[i] / steps[i]);
    const std::int32_t counted = wrapped(counts, counter_bits);
    wraps = wraps || counted != counts;
    (*q)[i] = counted * steps[i];
  }
  return kinematics.tip(*q);
}

void Encoder::declare(config::Visitor& v) {
  const auto where = v.variant("at", at, {{"tip", At::tip}, {"joints", At::joints}},
                               {.help = "where the steps are equal: at the tip, or at the joints "
                                        "of [device.kinematics]",
                                .source = "tip: what data sheets state"});
  where.only({At::tip}, [&] {
    v.quantity("resolution", resolution, config::Dimension::length, config::between(1e-9, 10e-3),
               {.help = "step of the position that is read, along each axis",
                .source = "Phantom Omni, nominal position resolution 0.055 mm (data sheet); "
                          "Premium 1.5: 0.03 mm"});
  });
  where.only({At::joints}, [&] { v.include(joints); });
}

Encoder::Reading Encoder::read(const Eigen::Vector3d& position,
                               const Kinematics* kinematics) const {
  Reading reading{position, false};
  if (at == At::tip) {
    for (int i = 0; i < 3; ++i) {
      reading.position[i] = std::round(position[i] / resolution) * resolution;
    }
    return reading;
  }
  const auto read = joints.read(*kinematics, position, reading.wrong);
  if (read) {
    reading.position = *read;
  } else {
    reading.wrong = true;
  }
  return reading;
}

}  // namespace hvp::plant
