#include "app/stability/loop_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/run/watches.h"
#include "app/scene/unit_contacts.h"
#include "app/stability/child_process.h"
#include "models/config/input_error.h"
#include "models/host/reference_run.h"
#include "models/plant/moving_device.h"
#include "vp/platform.h"

namespace hvp::app {

namespace {

// A loop comes to rest if its swing in the last quarter is below this part of that in the second.
// The value is that of a bisection to 0.1 % (docs/stability.md).
constexpr double kComesToRest = 0.9999;
constexpr double kRegister = 5e-9;  // m; what the words of position and force may keep moving
constexpr double kCounts = 1;       // of an encoder, likewise

// Until the first force arrives only the push acts, so a stable loop may swing wider than its
// initial displacement, but at the end by no more than this factor.
constexpr double kWide = 2;

// Measures the swing of the tip along the wall's normal in each quarter of the run.
class TrialWatch : public vp::FrameObserver {
 public:
  TrialWatch(const host::Wall& wall, int frames) : wall_(wall), quarter_(frames / 4) {}

  void closed(const vp::Frame& frame, const vp::CriticalPath& /*path*/) override {
    const double depth = wall_.depth(frame.devices.front().plant.tip.position);
    const std::int64_t quarter = std::min<std::int64_t>(3, frame.number / quarter_);
    quarters_[static_cast<std::size_t>(quarter)].add(depth);
    // The tip began in the wall, so a decaying swing stays there.
    left_ = left_ || (quarter >= 2 && depth < 0 && wall_.sides == host::Wall::Sides::one);
    delay_ += frame.born + frame.latency() - frame.latched;
    ++frames_;
  }

  // `displaced` is the initial displacement in m.
  Trial trial(double still, double displaced) const {
    const Quarter& before = quarters_[1];
    const Quarter& last = quarters_[3];
    Trial trial;
    trial.amplitude_m = 0.5 * (last.most - last.least);
    trial.growth = before.squares > 0 ? std::sqrt(last.squares / before.squares) : 0;
    trial.delay_s = frames_ > 0 ? to_seconds(delay_) / static_cast<double>(frames_) : 0;
    const bool shrinks = trial.growth < kComesToRest && trial.amplitude_m < kWide * displaced;
    trial.stable = !left_ && (trial.amplitude_m <= still || shrinks);
    return trial;
  }

 private:
  struct Quarter {
    double count = 0;
    double mean = 0;
    double squares = 0;  // about the mean (Welford 1962)
    double least = 0;
    double most = 0;

    void add(double depth) {
      if (count == 0) least = most = depth;
      count += 1;
      const double off = depth - mean;
      mean += off / count;
      squares += off * (depth - mean);
      least = std::min(least, depth);
      most = std::max(most, depth);
    }
  };

  const host::Wall& wall_;
  std::int64_t quarter_;
  std::array<Quarter, 4> quarters_;
  bool left_ = false;
  Picoseconds delay_ = 0;
  std::int64_t frames_ = 0;
};

double still(const Scenario& s) {
  const std::optional<plant::Encoder>& encoder = s.device.encoder;
  if (!encoder) return kRegister;
  const double step = encoder->at == plant::Encoder::At::tip ? encoder->resolution : 0;
  return std::max(kRegister, kCounts * step);
}

Trial run_trial(const Scene& scene, double stiffness, const TrialSettings& settings) {
  vp::PlatformSettings p = platform_settings(scene);
  host::Wall& wall = p.wall.value();
  wall.stiffness_N_m = stiffness;
  p.frames = 4 * std::max(1, settings.frames / 4);
  const double depth = settings.push_N / stiffness;
  const Eigen::Vector3d n = wall.direction();
  plant::Trajectory rest = p.probes.front();
  rest.start += (wall.depth(rest.start) - depth) * n;
  rest.motion = {{.phase = plant::Stroke::hold, .to = rest.start, .duration = 1}};
  p.probes = {rest};
  plant::Plant plant = plant::plant_of(p.device, p.hand, rest);
  plant.displaced = -kDisplaced * depth * n;
  plant.push = -settings.push_N * n;
  if (plant.gravity) plant.push -= plant.weight();
  plant::MovingDevice device(plant);
  p.haptic_devices = {&device};
  vp::Platform platform(p, std::nullopt, nullptr);
  TrialWatch watch(wall, p.frames);
  platform.add_observer(watch);
  platform.run();
  return watch.trial(still(scene.scenario()), kDisplaced * depth);
}

Trial run_body(const Scene& scene, double times) {
  Scenario s = scene.scenario();
  s.object.material.young_modulus_pa *= times;
  Scene stiffer(s, scene.device(), {}, Scene::Limits::reported);
  const vp::SoftBody soft{stiffer.body(), stiffer.computation(), stiffer.contacts()};
  vp::Platform platform(platform_settings(stiffer), soft, nullptr);
  LoopWatch watch(stiffer.scenario());
  platform.add_observer(watch);
  platform.run();
  Trial trial{.stable = true, .delay_s = watch.mean_delay_s()};
  for (const plant::LoopQuality& quality : watch.qualities()) {
    if (!quality.oscillation().measured()) {
      throw InputError("probe.motion",
                       "nobody rests long enough to see whether the device comes to rest: expected "
                       "a hold of at least 0.6 s");
    }
    const auto& cycle = quality.cycle();
    if (!cycle) continue;
    trial.stable = false;
    trial.amplitude_m = std::max(trial.amplitude_m, cycle->amplitude_m);
  }
  return trial;
}

Trial trial_in_child(const std::function<Trial()>& run) {
  using nlohmann::json;
  const json answer = json::parse(in_child([&run] {
    const Trial t = run();
    return json{{"stable", t.stable},
                {"growth", std::isfinite(t.growth) ? t.growth : 1e300},
                {"amplitude", t.amplitude_m},
                {"delay", t.delay_s}}
        .dump();
  }));
  return {answer["stable"].get<bool>(), answer["growth"].get<double>(),
          answer["amplitude"].get<double>(), answer["delay"].get<double>()};
}

}  // namespace

Trial try_body(const Scene& scene, double times) {
  return trial_in_child([&] { return run_body(scene, times); });
}

double contact_stiffness(const Scene& scene) {
  const std::vector<host::UnitContact> contacts = unit_contacts(scene);
  const auto deepest = std::ranges::max_element(
      contacts, {}, [](const host::UnitContact& c) { return c.displacement.norm(); });
  const fem::Body& body = scene.body();
  host::ReferenceRun run(body, std::nullopt, scene.scenario().budget.period_s, body.stiffness(),
                         body.stiffness());
  const std::vector<Eigen::Vector3d> displacement(deepest->nodes.size(), deepest->displacement);
  run.step({deepest->nodes, displacement, {}, 0});
  const double depth = deepest->displacement.norm();
  return depth > 0 ? std::abs(run.force().dot(deepest->displacement)) / (depth * depth) : 0;
}

Trial try_wall(const Scene& scene, double stiffness, const TrialSettings& settings) {
  return trial_in_child([&] { return run_trial(scene, stiffness, settings); });
}

}  // namespace hvp::app
