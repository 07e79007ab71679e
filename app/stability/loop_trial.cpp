#include "app/stability/loop_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/process/child_process.h"
#include "app/run/watches.h"
#include "models/config/input_error.h"
#include "models/plant/daq.h"
#include "models/plant/moving_device.h"
#include "vp/platform.h"

namespace hvp::app {

namespace {

// A loop comes to rest if its swing in the last quarter is below this part of that in the second.
// The value is that of a bisection to 0.1 % (docs/stability.md).
constexpr double kComesToRest = 0.9999;
constexpr double kRegister = 5e-9;  // m; what the words of position and force may keep moving
constexpr double kGone = 1e-4;      // of the initial displacement: near the edge they keep more
constexpr double kCounts = 1;       // of an encoder, likewise

// Until the first force arrives only the push acts, so a stable loop may swing wider than its
// initial displacement, but at the end by no more than this factor.
constexpr double kWide = 1.5;

// Measures the swing of the tip along the wall's normal in each quarter of the run. Its size is
// sqrt(x^2 + (v/w)^2), with w of the swing itself: unlike the rms of x it does not depend on the
// phase in which a quarter begins.
class TrialWatch : public vp::FrameObserver {
 public:
  TrialWatch(const host::Wall& wall, int frames) : wall_(wall), quarter_(frames / 4) {}

  void closed(const vp::Frame& frame, const vp::CriticalPath& /*path*/) override {
    const vp::DeviceRecord& device = frame.devices.front();
    const double depth = wall_.depth(device.plant.tip.position);
    const std::int64_t quarter = std::min<std::int64_t>(3, frame.number / quarter_);
    quarters_[static_cast<std::size_t>(quarter)].add(
        depth, device.plant.tip.velocity.dot(wall_.direction()));
    // The tip began in the wall, so a decaying swing stays there.
    left_ = left_ || (quarter >= 2 && depth < 0 && wall_.sides == host::Wall::Sides::one);
    // A force that is clamped at the end keeps a swing from growing, not from going on.
    const bool clamped = device.drive.dac_saturated || device.drive.current_saturated ||
                         frame.sent(0).cwiseAbs().maxCoeff() > plant::kForce.largest();
    clamped_ = clamped_ || clamped;
    saturated_ = saturated_ || (quarter == 3 && clamped);
    delay_ += frame.born + frame.latency() - frame.latched;
    ++frames_;
  }

  // `displaced` is the initial displacement in m.
  Trial trial(double still, double displaced) const {
    const Quarter& last = quarters_[3];
    const double mean = (quarters_[1].mean + quarters_[2].mean + last.mean) / 3;
    Trial trial;
    trial.amplitude_m = 0.5 * (last.most - last.least);
    const double position = quarters_[1].squares_about(mean) + last.squares_about(mean);
    const double velocity = quarters_[1].speeds + last.speeds;
    const double slowness = velocity > 0 ? position / velocity : 0;  // 1/w^2
    const auto swing = [&](const Quarter& q) {
      return q.count > 0 ? (q.squares_about(mean) + slowness * q.speeds) / q.count : 0;
    };
    const double before = swing(quarters_[1]);
    trial.growth = before > 0 ? std::sqrt(swing(last) / before) : 0;
    trial.delay_s = frames_ > 0 ? to_seconds(delay_) / static_cast<double>(frames_) : 0;
    const bool shrinks =
        trial.growth < kComesToRest && trial.amplitude_m < kWide * displaced && !saturated_;
    trial.clamped = clamped_;
    trial.stable = !left_ && (trial.amplitude_m <= still || shrinks);
    trial.moved = quarters_[0].most > quarters_[0].least;
    return trial;
  }

 private:
  struct Quarter {
    double count = 0;
    double mean = 0;
    double squares = 0;  // about the mean (Welford 1962)
    double speeds = 0;   // squared
    double least = 0;
    double most = 0;

    void add(double depth, double speed) {
      if (count == 0) least = most = depth;
      count += 1;
      const double off = depth - mean;
      mean += off / count;
      squares += off * (depth - mean);
      speeds += speed * speed;
      least = std::min(least, depth);
      most = std::max(most, depth);
    }
    double squares_about(double place) const {
      return squares + count * (mean - place) * (mean - place);
    }
  };

  const host::Wall& wall_;
  std::int64_t quarter_;
  std::array<Quarter, 4> quarters_;
  bool left_ = false;
  bool clamped_ = false;
  bool saturated_ = false;  // in the last quarter
  Picoseconds delay_ = 0;
  std::int64_t frames_ = 0;
};

double still(const Scenario& s) {
  const std::optional<plant::Encoder>& encoder = s.device_of(0).encoder;
  if (!encoder) return kRegister;
  const double step = encoder->at == plant::Encoder::At::tip ? encoder->resolution : 0;
  return std::max(kRegister, kCounts * step);
}

// Each quarter of a trial has eight swings of the device's mass on the wall.
constexpr double kSwings = 4 * 8;
// A trial of that many frames takes some seconds.
constexpr double kMostFrames = 400'000;

double frames_for(const Scenario& s, double stiffness, const TrialSettings& settings) {
  const plant::Plant plant = plant::plant_of(s.device_of(0), s.hand_of(0), s.probes.front());
  double mass = 0;
  for (int i = 0; i < 3; ++i) mass = std::max(mass, plant.masses()[i]);
  if (plant.hand) mass += plant.hand->mass_kg;
  const double swing_s = 2 * std::numbers::pi * std::sqrt(mass / stiffness);
  return std::max<double>(settings.frames, kSwings * swing_s / s.budget.period_s);
}

Trial run_trial(const Scene& scene, double stiffness, const TrialSettings& settings) {
  vp::PlatformSettings p = platform_settings(scene);
  host::Wall& wall = p.wall.value();
  wall.stiffness_N_m = stiffness;
  const double frames = frames_for(scene.scenario(), stiffness, settings);
  if (frames > kMostFrames) return {.decided = false};
  p.frames = 4 * std::max(1, static_cast<int>(frames) / 4);
  const auto& coupling = p.host.virtual_coupling;
  const double depth = settings.push_N / (coupling ? coupling->in_series(stiffness) : stiffness);
  const Eigen::Vector3d n = wall.direction();
  plant::Probe rest = p.probes.front();
  rest.start += (wall.depth(rest.start) - depth) * n;
  rest.motion = {{.phase = plant::Stroke::hold, .to = rest.start, .duration = 1}};
  p.probes = {rest};
  plant::Plant plant = plant::plant_of(p.device_of(0), p.hand_of(0), rest);
  plant.displaced = -kDisplaced * depth * n;
  plant.push = -settings.push_N * n;
  if (plant.gravity) plant.push -= plant.weight();
  plant::MovingDevice device(plant);
  p.haptic_devices = {&device};
  vp::Platform platform(p, std::nullopt, nullptr);
  TrialWatch watch(wall, p.frames);
  platform.add_observer(watch);
  platform.run();
  const double displaced = kDisplaced * depth;
  return watch.trial(std::max(still(scene.scenario()), kGone * displaced), displaced);
}

// The scenario's own motion.
Trial run_motion(const Scenario& s, vp::Platform& platform) {
  LoopWatch watch(s);
  platform.add_observer(watch);
  platform.run();
  Trial trial{.moved = true, .stable = true, .delay_s = watch.mean_delay_s()};
  for (const plant::LoopQuality& quality : watch.qualities()) {
    if (!quality.rest().compared()) {
      throw InputError("probe.motion",
                       "nobody rests long enough to see whether the device comes to rest: expected "
                       "a hold of at least 0.6 s");
    }
    const auto& cycle = quality.rest().cycle();
    if (!cycle) continue;
    trial.stable = false;
    trial.amplitude_m = std::max(trial.amplitude_m, cycle->amplitude_m);
  }
  return trial;
}

Trial run_body(const Scene& scene, double times) {
  Scenario s = scene.scenario();
  s.object.material.young_modulus_pa *= times;
  for (fem::Region& region : s.object.regions) {
    if (region.material) region.material->young_modulus_pa *= times;
  }
  Scene stiffer(s, scene.device(), {}, Scene::Limits::reported);
  vp::Platform platform(platform_settings(stiffer), soft_body(stiffer), nullptr);
  return run_motion(stiffer.scenario(), platform);
}

// Whether a wall has answered.
class PressWatch : public vp::FrameObserver {
 public:
  void closed(const vp::Frame& frame, const vp::CriticalPath& /*path*/) override {
    pressed_ = pressed_ || frame.in_contact();
  }
  bool pressed() const { return pressed_; }

 private:
  bool pressed_ = false;
};

Trial run_motion_on_wall(const Scene& scene, double stiffness) {
  Scenario s = scene.scenario();
  s.wall.value().stiffness_N_m = stiffness;
  vp::PlatformSettings settings = platform_settings(scene);
  settings.wall = s.wall;
  vp::Platform platform(settings, std::nullopt, nullptr);
  PressWatch press;
  platform.add_observer(press);
  Trial trial = run_motion(s, platform);
  trial.pressed = press.pressed();
  // As of a trial that is pushed: what goes on within an encoder's step is the encoder's.
  if (trial.amplitude_m <= still(s)) trial.stable = true;
  return trial;
}

Trial trial_in_child(const std::function<Trial()>& run) {
  using nlohmann::json;
  const json answer = json::parse(in_child([&run] {
    const Trial t = run();
    return json{
        {"decided", t.decided},       {"moved", t.moved},
        {"pressed", t.pressed},       {"stable", t.stable},
        {"clamped", t.clamped},       {"growth", std::isfinite(t.growth) ? t.growth : 1e300},
        {"amplitude", t.amplitude_m}, {"delay", t.delay_s}}
        .dump();
  }));
  return {answer["decided"].get<bool>(),     answer["moved"].get<bool>(),
          answer["stable"].get<bool>(),      answer["clamped"].get<bool>(),
          answer["pressed"].get<bool>(),     answer["growth"].get<double>(),
          answer["amplitude"].get<double>(), answer["delay"].get<double>()};
}

}  // namespace

Trial try_motion(const Scene& scene, double stiffness_N_m) {
  return trial_in_child([&] { return run_motion_on_wall(scene, stiffness_N_m); });
}

Trial try_body(const Scene& scene, double times) {
  return trial_in_child([&] { return run_body(scene, times); });
}

Trial try_wall(const Scene& scene, double stiffness, const TrialSettings& settings) {
  return trial_in_child([&] { return run_trial(scene, stiffness, settings); });
}

}  // namespace hvp::app
