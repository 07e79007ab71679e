#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/config/declaration.h"
#include "models/plant/daq.h"
#include "models/plant/device.h"
#include "models/plant/encoder.h"
#include "models/plant/linkages.h"
#include "models/plant/output_stage.h"
#include "models/plant/plant.h"
#include "models/plant/trajectory.h"

namespace hvp::plant {

// The effect [device.limits]: the limits that the device's maker states. The force is clamped; a
// wall's stiffness and damping only appear in the report.
struct DeviceLimits {
  double force_N = 8.5;
  double stiffness_N_m = 0;  // 0: not stated
  double damping_N_s_m = 0;  // 0: not stated

  void declare(config::Visitor& v);
};

// The scenario's table [device]: the haptic device, and the board that reads and drives it.
struct DeviceSettings {
  std::string model;  // a name in the catalogue, or a file; empty: none
  Daq daq;
  std::optional<Encoder> encoder;
  std::optional<DeviceDynamics> dynamics;
  std::optional<Friction> friction;
  std::optional<Gravity> gravity;
  std::optional<KinematicsSettings> kinematics;
  std::optional<Dac> dac;
  std::optional<Adc> adc;
  std::optional<Amplifier> amplifier;
  std::optional<Motor> motor;
  std::optional<DeviceLimits> limits;

  void declare(config::Visitor& v);
  // Throws InputError: encoders at the joints of a device without kinematics.
  void check() const;
};

// The device of these settings, gripped by `hand` where there is one, whose intended motion is
// `probe`. A device without [device.dynamics] moves along `probe` whatever the force
// (PrescribedPath). Throws InputError: a motion too fast to be followed.
std::unique_ptr<Device> make_device(const DeviceSettings& settings, const std::optional<Hand>& hand,
                                    const Trajectory& probe);

// The same device as a plant, for programs that study it by itself. It needs dynamics.
Plant plant_of(const DeviceSettings& settings, const std::optional<Hand>& hand,
               const Trajectory& probe);

// Throws InputError, with one of the probe's keys, where the motion leaves the device's reach.
void require_reachable(const DeviceSettings& settings, const Trajectory& probe);

}  // namespace hvp::plant
