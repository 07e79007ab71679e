#include "app/run/loop_watch.h"

#include <algorithm>
#include <utility>

#include "models/time/picoseconds.h"

namespace hvp::app {

LoopWatch::LoopWatch(const Scenario& scenario)
    : scenario_(scenario), qualities_(scenario.probes.size()) {
  const auto& kinematics = scenario.device.kinematics;
  if (kinematics) kinematics_ = plant::make_kinematics(*kinematics);
}

// A hand rests where its intended motion does; nobody's rests always. What comes after it has let
// go is not compared with what was before.
bool LoopWatch::rests(std::size_t probe, Picoseconds time) const {
  const std::optional<plant::Hand>& hand = scenario_.hand;
  if (!hand) return true;
  if (hand->lets_go_s > 0 && to_seconds(time) >= hand->lets_go_s) {
    return to_seconds(time) >= hand->lets_go_s + scenario_.budget.period_s;
  }
  return scenario_.probes[probe].state_ps(time).velocity.isZero(0);
}

void LoopWatch::Delays::add(const vp::Frame& frame, const vp::CriticalPath& path) {
  ++frames;
  sum += frame.born + frame.latency() - frame.latched;
  for (const vp::SpanId id : path.spans()) {
    const vp::Span& span = frame.spans[static_cast<std::size_t>(id)];
    if (span.end <= frame.latched) continue;
    parts[static_cast<std::size_t>(span.part) * vp::kPhases +
          static_cast<std::size_t>(span.phase)] += span.end - std::max(span.start, frame.latched);
  }
}

void LoopWatch::closed(const vp::Frame& frame, const vp::CriticalPath& path) {
  all_.add(frame, path);
  if (frame.in_contact()) in_contact_.add(frame, path);
  const Picoseconds latched = frame.time + frame.latched - frame.born;
  for (std::size_t i = 0; i < frame.devices.size(); ++i) {
    const vp::DeviceRecord& record = frame.devices[i];
    plant::LoopSample sample{frame.number,      to_seconds(latched), {}, record.plant, record.drive,
                             record.read_wrong, rests(i, latched)};
    sample.view = {frame.touches[i].tip, -frame.touches[i].force, 0};
    if (scenario_.wall) sample.view.stored = scenario_.wall->energy(record.plant.tip.position);
    sample.unreachable =
        kinematics_ && !kinematics_->regular_joints(record.plant.tip.position).has_value();
    qualities_[i].add(sample);
  }
}

stability::Flags LoopWatch::flags() const {
  stability::Flags flags;
  for (const plant::LoopQuality& quality : qualities_) flags.merge(quality.flags());
  return flags;
}

double LoopWatch::mean_delay_s() const {
  if (delays().frames == 0) return 0;
  return to_seconds(delays().sum) / static_cast<double>(delays().frames);
}

std::optional<results::StiffnessBudget> LoopWatch::stiffness() const {
  if (delays().frames == 0) return std::nullopt;
  std::vector<results::StiffnessBudget::Share> shares;
  const auto& parts = delays().parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] == 0) continue;
    shares.push_back({vp::kPartNames[i / vp::kPhases], vp::kPhaseNames[i % vp::kPhases],
                      to_seconds(parts[i]) / static_cast<double>(delays().frames)});
  }
  const Eigen::Vector3d direction =
      scenario_.wall ? scenario_.wall->direction() : Eigen::Vector3d::UnitZ();
  const std::optional<plant::WallLoop> loop = wall_loop(scenario_, mean_delay_s(), direction);
  if (!loop) return std::nullopt;
  return results::stiffness_budget(*loop, scenario_.device.dynamics->damping_N_s_m,
                                   std::move(shares));
}

std::optional<plant::WallLoop> wall_loop(const Scenario& s, double delay_s,
                                         const Eigen::Vector3d& direction) {
  const plant::Plant plant = plant::plant_of(s.device, s.hand, s.probes.front());
  std::optional<plant::LinearAxis> axis;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0) continue;
    if (axis && axis->mass != plant.axis(i).mass) return std::nullopt;
    axis = plant.axis(i);
  }
  return plant::WallLoop{axis.value(), s.budget.period_s, delay_s,
                         s.wall ? s.wall->damping_N_s_m : 0};
}

}  // namespace hvp::app
