#include "models/plant/device.h"

#include <limits>
#include <stdexcept>
#include <string>

namespace hvp::plant {

namespace {
constexpr Picoseconds kBeforeAll = std::numeric_limits<Picoseconds>::min();
constexpr std::size_t kChanges = 8;  // more than are ahead with any output delay below 8 periods

void require_order(const char* what, Picoseconds time, Picoseconds last) {
  if (time >= last) return;
  throw std::logic_error(std::string("a device ") + what + " for " + std::to_string(time) +
                         " ps, after " + std::to_string(last) + " ps; times must not decrease");
}
}  // namespace

Device::Device() : asked_(kBeforeAll), driven_(kBeforeAll) { ahead_.reserve(kChanges); }

TipState Device::at(Picoseconds time) {
  require_order("was asked", time, asked_);
  asked_ = time;
  auto change = ahead_.begin();
  for (; change != ahead_.end() && change->from <= time; ++change) {
    advance_to(change->from);
    const Eigen::Vector3d place = state().position;
    works_ = works_until(place);
    began_at_ = place;
    force_ = change->force;
    of_host_ = change->of_host;
  }
  ahead_.erase(ahead_.begin(), change);
  advance_to(time);
  return state();
}

void Device::drive(Picoseconds from, const Eigen::Vector3d& force, const Eigen::Vector3d& of_host) {
  require_order("was driven", from, asked_);
  require_order("was driven", from, driven_);
  driven_ = from;
  ahead_.push_back({from, force, of_host});
}

PlantState Device::plant() const {
  PlantState plant = mechanics();
  plant.works = works_until(plant.tip.position);
  return plant;
}

CommandWork Device::works_until(const Eigen::Vector3d& place) const {
  const Eigen::Vector3d way = place - began_at_;
  return {works_.of_command + force_.dot(way), works_.of_host + of_host_.dot(way)};
}

void Device::advance_to(Picoseconds time) {
  if (time <= reached_) return;
  advance(reached_, time, force_);
  reached_ = time;
}

}  // namespace hvp::plant
