#include "app/run/watches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "models/time/picoseconds.h"

namespace hvp::app {

namespace {

// A share of the body's diagonal at rest. A probe at 50 mm/s goes 2 mm in the 41 ms that a contact
// may be late with the defaults, and it is slow where it touches.
constexpr double kAllowed = 0.01;

double diagonal(const collision::DeformedSurface& surface) {
  Eigen::AlignedBox3d box;
  for (const int node : surface.surface_nodes()) box.extend(surface.rest_position(node));
  return box.diagonal().norm();
}

}  // namespace

bool ContactWatch::begins_pressed(const vp::Frame& frame) {
  return std::ranges::any_of(frame.touches, [](const collision::Touch& touch) {
    return touch.contact.present() && touch.force.norm() > stability::ForceQuality::kNoForce;
  });
}

void ContactWatch::closed(const vp::Frame& frame, const vp::CriticalPath& /*path*/) {
  if (first_without_start_ >= 0) return;
  if (stability::Flags(frame.flags).has(stability::Flag::no_start)) {
    first_without_start_ = frame.number;
  }
}

stability::Flags ContactWatch::flags() const {
  stability::Flags flags;
  if (begins_pressed_) flags.raise(stability::Flag::force_step);
  if (figures_.proxy.too_soft()) flags.raise(stability::Flag::contact_doubtful);
  return flags;
}

ApproachWatch::ApproachWatch(const collision::ContactSearch& contacts)
    : contacts_(contacts), allowed_(kAllowed * diagonal(contacts.surface())) {}

void ApproachWatch::solved(const vp::Frame& frame, const vp::Solution& solution) {
  ContactWatch::solved(frame, solution);
  if (frame.in_contact()) {
    touched_ = true;
    figures_.nearest.reset();
  }
  for (const collision::Touch& touch : frame.touches) {
    if (touch.contact.present()) continue;
    const results::Approach here{contacts_.surface().signed_distance(touch.tip), frame.number,
                                 touch.tip};
    std::optional<results::Approach>& nearest = figures_.nearest;
    if (!touched_ && (!nearest || here.distance < nearest->distance)) nearest = here;
    if (!deepest_ || here.distance < deepest_->distance) deepest_ = here;
  }
}

results::ContactFigures ApproachWatch::figures() const {
  results::ContactFigures figures = figures_;
  figures.missed = missed();
  return figures;
}

std::optional<results::Approach> ApproachWatch::missed() const {
  if (!deepest_ || deepest_->distance > -allowed_) return std::nullopt;
  return deepest_;
}

stability::Flags ApproachWatch::flags() const {
  stability::Flags flags = ContactWatch::flags();
  if (missed()) flags.raise(stability::Flag::contact_missed);
  return flags;
}

void ForceWatch::solved(const vp::Frame& frame, const vp::Solution& solution) {
  for (std::size_t i = 0; i < qualities_.size(); ++i) {
    const collision::Touch& touch = frame.touches[i];
    stability::FeltForce felt{frame.number,
                              to_seconds(frame.time),
                              frame.read(i),
                              frame.sent(i),
                              touch.contact.node,
                              !solution.hold.let_go.empty(),
                              0};
    if (touch.contact.present()) {
      felt.pull = touch.force.dot(contacts_.surface().rest_normal(touch.contact.node));
    }
    if (touch.contact.spot.present() && at_rest_ != nullptr) {
      // Found by itself: where a proxy stands is what is judged.
      felt.foot = at_rest_->closest(felt.tip).point;
      felt.normal = touch.normal;
      felt.pull = 0;
    }
    qualities_[i].add(felt);
  }
}

StrainWatch::StrainWatch(const fem::Body& body, const std::optional<tissue::Model>& model)
    : body_(body),
      law_(tissue::LawKind::linear),
      meter_(body.mesh(), fem::kLinearStrain),
      solution_(body.load().size()),
      displacement_(3 * body.mesh().nodes.size()) {
  if (model && model->springs) {
    law_.reset();
  } else if (model) {
    law_ = model->kind;
  }
}

void StrainWatch::solved(const vp::Frame& frame, const vp::Solution& solution) {
  // A body at rest, which has been measured, is not measured again.
  if (worst_frame_ >= 0 && std::ranges::equal(solution.displacement, solution_)) return;
  std::ranges::copy(solution.displacement, solution_.begin());
  body_.expand(solution.displacement, displacement_);
  const fem::Strains strains = meter_.measure(displacement_);
  const int inverted = std::max(worst_.inverted, strains.inverted);
  const double beyond = std::max(worst_.beyond_share, strains.beyond_share);
  const double stretched = std::max(worst_.stretched_share, strains.stretched_share);
  const double largest_stretch = std::max(worst_.largest_stretch, strains.largest_stretch);
  if (worst_frame_ < 0 || strains.largest > worst_.largest) {
    worst_ = strains;
    worst_frame_ = frame.number;
  }
  worst_.inverted = inverted;
  worst_.beyond_share = beyond;
  worst_.stretched_share = stretched;
  worst_.largest_stretch = largest_stretch;
}

stability::Flags StrainWatch::flags() const {
  stability::Flags flags;
  // Springs do not see the volume between them; a law's own elements are watched where their
  // forces are formed.
  if (!law_ && worst_.inverted > 0) flags.raise(stability::Flag::inverted_element);
  const bool in_strain =
      law_ == tissue::LawKind::corotational || law_ == tissue::LawKind::st_venant_kirchhoff;
  if ((law_ == tissue::LawKind::linear && fem::beyond_linearity(worst_)) ||
      (in_strain && fem::beyond_linear_stretch(worst_))) {
    flags.raise(stability::Flag::beyond_linearity);
  }
  return flags;
}

LoopWatch::LoopWatch(const Scenario& scenario)
    : scenario_(scenario), qualities_(scenario.probes.size()) {
  forces_.reserve(scenario.probes.size());
  for (std::size_t i = 0; i < scenario.probes.size(); ++i) {
    const auto& kinematics = scenario.device_of(i).kinematics;
    kinematics_.push_back(kinematics ? plant::make_kinematics(*kinematics) : nullptr);
  }
}

// A hand rests where its intended motion does; nobody's rests always. What comes after it has let
// go is not compared with what was before.
bool LoopWatch::rests(std::size_t probe, Picoseconds time) const {
  const std::optional<plant::Hand> hand = scenario_.hand_of(probe);
  if (!hand) return true;
  if (hand->lets_go_s > 0 && to_seconds(time) >= hand->lets_go_s) {
    return to_seconds(time) >= hand->lets_go_s + scenario_.budget.period_s;
  }
  return scenario_.probes[probe].state_ps(time).velocity.isZero(0);
}

void LoopWatch::Delays::add(const vp::Frame& frame, const vp::CriticalPath& path) {
  ++frames;
  const Picoseconds delay = frame.born + frame.latency() - frame.latched;
  sum += delay;
  worst = std::max(worst, delay);
  for (const vp::SpanId id : path.spans()) {
    const vp::Span& span = frame.spans[static_cast<std::size_t>(id)];
    if (span.end <= frame.latched) continue;
    parts[static_cast<std::size_t>(span.part) * vp::kPhases +
          static_cast<std::size_t>(span.phase)] += span.end - std::max(span.start, frame.latched);
  }
}

bool LoopWatch::force_changed(const vp::Frame& frame) {
  bool changed = forces_.empty();
  forces_.resize(frame.touches.size());
  for (std::size_t i = 0; i < forces_.size(); ++i) {
    const Eigen::Vector3d sent = frame.sent(i);
    changed = changed || sent != forces_[i];
    forces_[i] = sent;
  }
  return changed;
}

void LoopWatch::closed(const vp::Frame& frame, const vp::CriticalPath& path) {
  all_.add(frame, path);
  if (force_changed(frame) && frame.in_contact()) moving_.add(frame, path);
  const Picoseconds latched = frame.time + frame.latched - frame.born;
  for (std::size_t i = 0; i < frame.devices.size(); ++i) {
    if (!scenario_.has_mass(i)) continue;
    const vp::DeviceRecord& record = frame.devices[i];
    plant::LoopSample sample{frame.number,      to_seconds(latched), {}, record.plant, record.drive,
                             record.read_wrong, rests(i, latched)};
    sample.view = {frame.read(i), -frame.sent(i), 0};
    if (scenario_.wall) sample.view.stored = scenario_.wall->energy(record.plant.tip.position);
    sample.unreachable =
        kinematics_[i] && !kinematics_[i]->regular_joints(record.plant.tip.position).has_value();
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

std::optional<plant::LinearAxis> LoopWatch::axis_without_hand(std::size_t probe) const {
  const std::optional<plant::Hand> hand = scenario_.hand_of(probe);
  const double run_s = static_cast<double>(scenario_.frames) * scenario_.budget.period_s;
  if (!hand || !(hand->lets_go_s > 0) || hand->lets_go_s >= run_s) return std::nullopt;
  Scenario alone = scenario_;
  alone.hand.reset();
  alone.probes[probe].hand.reset();
  const Eigen::Vector3d direction = alone.wall ? alone.wall->direction() : Eigen::Vector3d::UnitZ();
  const std::optional<plant::WallLoop> loop = wall_loop(alone, probe, 0, direction);
  if (!loop) return std::nullopt;
  return loop->device;
}

std::vector<results::StiffnessBudget> LoopWatch::stiffnesses(
    std::optional<double> contact_N_m) const {
  std::vector<results::StiffnessBudget> all;
  const bool own = scenario_.any_own_device();
  for (std::size_t i = 0; i < scenario_.probes.size(); ++i) {
    if (!scenario_.has_mass(i)) continue;
    std::optional<results::StiffnessBudget> budget = stiffness(i, contact_N_m);
    if (budget && own) budget->probe = i;
    if (budget) all.push_back(std::move(*budget));
    if (!own) break;
  }
  return all;
}

std::optional<results::StiffnessBudget> LoopWatch::stiffness(
    std::size_t probe, std::optional<double> contact_N_m) const {
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
  const std::optional<plant::WallLoop> loop =
      wall_loop(scenario_, probe, mean_delay_s(), direction);
  if (!loop) return std::nullopt;
  return results::stiffness_budget(*loop, scenario_.device_of(probe).dynamics->damping_N_s_m,
                                   {.worst_delay_s = to_seconds(delays().worst),
                                    .frames = delays().frames,
                                    .moving = moving_.frames > 0,
                                    .contact_N_m = contact_N_m,
                                    .let_go = axis_without_hand(probe),
                                    .after_latch = std::move(shares)});
}

std::optional<plant::WallLoop> wall_loop(const Scenario& s, std::size_t probe, double delay_s,
                                         const Eigen::Vector3d& direction) {
  plant::Plant plant = plant::plant_of(s.device_of(probe), s.hand_of(probe), s.probes[probe]);
  if (s.wall && plant.pose_of_mass()) {
    // The mass of the pose at the wall, before the probe's start.
    Eigen::Vector3d& place = plant.intended.start;
    const Eigen::Vector3d at_wall = place + s.wall->depth(place) * s.wall->direction();
    if (plant.pose_of_mass()->regular_joints(at_wall)) place = at_wall;
  }
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
