#include "models/plant/device_settings.h"

#include <fmt/format.h>

#include "models/config/effects.h"
#include "models/config/input_error.h"
#include "models/plant/moving_device.h"

namespace hvp::plant {

namespace {

constexpr std::string_view kNoMass = "only a device with mass can be moved by a force";

}  // namespace

void DeviceLimits::declare(config::Visitor& v) {
  v.quantity("force", force_N, config::Dimension::force, {.min = 0, .max = 1e6, .min_open = true},
             {"largest force; a larger one is clamped, its direction kept",
              "PHANTOM Premium 1.5: CHAI3D, src/devices/CPhantomDevices.cpp"});
  v.quantity("stiffness", stiffness_N_m, config::Dimension::stiffness, config::between(0, 1e9),
             {"largest stiffness that a program is to ask for; 0: not stated",
              "0: makers rarely state one"});
  v.quantity("damping", damping_N_s_m, config::Dimension::damping, config::between(0, 1e6),
             {"likewise, damping; 0: not stated", "0: likewise"});
}

void DeviceSettings::declare(config::Visitor& v) {
  declare_model(v);
  v.table("daq", daq, {"the data acquisition board"});
  declare_parts(v);
}

void DeviceSettings::declare_model(config::Visitor& v) {
  v.text("model", model,
         {"a ready device: a name of haptic-devices/, or a file that ends in .toml with keys of "
          "this table. What the scenario states itself counts more",
          "none: an ideal device that its user moves whatever the force"});
}

void DeviceSettings::declare_parts(config::Visitor& v) {
  v.effect(
      "encoder", encoder,
      {"the position is read in steps", "no cost: the position is rounded where it is latched"});
  v.effect("dynamics", dynamics,
           {"the device has mass and damping, and forces move it",
            "no module: its motion is integrated exactly between changes of the force and, where "
            "its mass follows the pose, of that, once a millisecond"});
  v.effect("structure", structure,
           {"the device bends: one structural mode between motors and encoders on one side and the "
            "hand on the other",
            "no module: a second mass in its exact motion",
            {config::Need{"device.dynamics", {config::kPresent}, kNoMass}}});
  v.effect("friction", friction,
           {"dry friction, with exact stick and slip",
            "no module: the instants at which it sticks and slips are found",
            {config::Need{"device.dynamics", {config::kPresent}, kNoMass}}});
  v.effect("gravity", gravity,
           {"the device has weight",
            "no cost: a constant force",
            {config::Need{"device.dynamics", {config::kPresent}, kNoMass}}});
  v.effect("kinematics", kinematics,
           {"joints between tip and motors: steps of the encoders and limits of the motors differ "
            "over the workspace",
            "no module: the inverse and J of each force and each reading"});
  v.effect(
      "dac", dac,
      {"currents are commanded in steps of a voltage",
       "no cost: a rounding of each command",
       {config::Need{"device.amplifier", {config::kPresent}, "its voltage commands a current"}}});
  v.effect(
      "adc", adc,
      {"the host reads the motors' currents beside the positions, in steps",
       "no module: three words a device more in the block of positions",
       {config::Need{"device.amplifier", {config::kPresent}, "it reads an amplifier's current"}}});
  v.effect("amplifier", amplifier,
           {"a current source with a limit, and a lag where it has a bandwidth",
            "no module: a clamp of each command, a first-order lag of the force",
            {config::Need{"device.motor", {config::kPresent}, "its current makes a torque"}}});
  v.effect("motor", motor,
           {"currents make torques, and torques forces", "no cost: two products of each command"});
  v.effect("limits", limits,
           {"what the maker lets a program ask of the device", "no cost: a clamp of each force"});
}

void DeviceSettings::check() const {
  if (encoder && encoder->at == Encoder::At::joints && !kinematics) {
    throw InputError("encoder.at",
                     "\"joints\" needs a device that has some: expected "
                     "[device.kinematics] too, or \"tip\"");
  }
  if (dynamics && dynamics->at == DeviceDynamics::At::joints && !kinematics) {
    throw InputError("dynamics.at",
                     "\"joints\" needs a device that has some: expected "
                     "[device.kinematics] too, or \"tip\"");
  }
}

void OwnDevice::declare(config::Visitor& v) {
  declare_model(v);
  declare_parts(v);
}

namespace {

// A probe's own tables by themselves: what an effect of its device needs is looked for here.
struct OwnTables {
  OwnDevice device;

  void declare(config::Visitor& v) { v.table("device", device, {"the probe's own device"}); }
};

}  // namespace

void Probe::declare(config::Visitor& v) {
  Trajectory::declare(v);
  v.optional_table("device", device,
                   {"the probe's own device, in place of [device] as a whole and with its keys but "
                    "`daq`, since the board is one; without this table the probe has [device]"});
  v.optional_table("hand", hand,
                   {"who holds the probe's device, in place of [hand] as a whole and with its "
                    "keys; without this table [hand] does, where the device has mass"});
}

void Probe::check() const {
  Trajectory::check();
  if (device) config::survey_effects(OwnTables{*device}).require_needs();
}

std::vector<config::Effect> Probe::effects() const {
  std::vector<config::Effect> own;
  if (device) own = config::survey_effects(OwnTables{*device}).effects();
  if (hand) own.push_back({"hand", true, "who holds the device", {}, {}});
  return own;
}

Plant plant_of(const DeviceSettings& settings, const std::optional<Hand>& hand,
               const Trajectory& probe) {
  Plant plant;
  plant.dynamics = settings.dynamics.value();
  plant.hand = hand;
  plant.friction = settings.friction;
  plant.gravity = settings.gravity;
  plant.kinematics = settings.kinematics;
  plant.structure = settings.structure;
  if (settings.amplifier) plant.force_lag_rate = settings.amplifier->lag_rate();
  plant.intended = probe;
  return plant;
}

std::unique_ptr<Device> make_device(const DeviceSettings& settings, const std::optional<Hand>& hand,
                                    const Trajectory& probe) {
  if (!settings.dynamics) return std::make_unique<PrescribedPath>(probe);
  return std::make_unique<MovingDevice>(plant_of(settings, hand, probe));
}

void require_reachable(const DeviceSettings& settings, const Trajectory& probe) {
  if (!settings.kinematics) return;
  const std::unique_ptr<Kinematics> kinematics = make_kinematics(*settings.kinematics);
  const auto require = [&](const Eigen::Vector3d& place, const std::string& key) {
    if (kinematics->regular_joints(place)) return;
    throw InputError(
        key, fmt::format("({:.4g}, {:.4g}, {:.4g}) mm is {} for [device.kinematics]: expected a "
                         "place that the arm reaches with no joints in line, or another "
                         "device.kinematics.home",
                         1e3 * place.x(), 1e3 * place.y(), 1e3 * place.z(),
                         kinematics->joints(place) ? "a singular pose" : "out of reach"));
  };
  require(probe.start, "start");
  constexpr int kPlaces = 64;  // of each stroke
  Eigen::Vector3d from = probe.start;
  for (std::size_t i = 0; i < probe.motion.size(); ++i) {
    const Eigen::Vector3d way = probe.motion[i].to - from;
    for (int n = 1; n <= kPlaces; ++n) {
      require(from + way * n / kPlaces, fmt::format("motion[{}].to", i));
    }
    from = probe.motion[i].to;
  }
}

}  // namespace hvp::plant
