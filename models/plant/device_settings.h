#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/config/declaration.h"
#include "models/config/effects.h"
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
  std::optional<Structure> structure;
  std::optional<Friction> friction;
  std::optional<Gravity> gravity;
  std::optional<KinematicsSettings> kinematics;
  std::optional<Dac> dac;
  std::optional<Adc> adc;
  std::optional<Amplifier> amplifier;
  std::optional<Motor> motor;
  std::optional<DeviceLimits> limits;

  void declare(config::Visitor& v);
  // Throws InputError: encoders or inertia at the joints of a device without kinematics.
  void check() const;

 protected:
  void declare_model(config::Visitor& v);
  void declare_parts(config::Visitor& v);  // all but the board
};

// A probe's own device, in place of [device] as a whole. The board is the scenario's, and `daq` is
// not used.
struct OwnDevice : DeviceSettings {
  void declare(config::Visitor& v);
};

// The scenario's table [probe]: a motion and, where they are not the scenario's shared ones, the
// device and the hand that have it.
struct Probe : Trajectory {
  std::optional<OwnDevice> device;
  std::optional<Hand> hand;

  Probe() = default;
  // One with the shared device and hand is its motion.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Probe(const Trajectory& trajectory) : Trajectory(trajectory) {}

  void declare(config::Visitor& v);
  // Throws InputError as Trajectory::check() does, and where an effect of its own device lacks what
  // it needs.
  void check() const;
  // The effects of its own tables, present and absent, with paths from [probe] on; empty where it
  // has none.
  std::vector<config::Effect> effects() const;
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
