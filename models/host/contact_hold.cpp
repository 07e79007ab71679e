#include "models/host/contact_hold.h"

#include <algorithm>
#include <cassert>

namespace hvp::host {

namespace {

bool contains(std::span<const int> ascending, int node) {
  return std::binary_search(ascending.begin(), ascending.end(), node);
}

}  // namespace

ContactHold::ContactHold(const fem::Body& body, const collision::ContactSearch& contacts,
                         Picoseconds hand_over, std::size_t probes)
    : body_(body),
      search_(contacts),
      probes_(probes, Probe{collision::HandOver(hand_over), {}, {}, {}}),
      contacts_(probes) {}

std::span<const int> ContactHold::nodes_of(std::span<const collision::Contact> contacts) {
  assert(contacts.size() == probes_.size());
  all_nodes_.clear();
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    std::vector<int>& nodes = probes_[i].next_nodes;
    nodes.clear();
    if (!contacts[i].present()) continue;
    for (const int node : search_.patch(contacts[i].node)) {
      const int active = body_.active_index(node);
      if (!contains(all_nodes_, active)) nodes.push_back(active);
    }
    all_nodes_.insert(all_nodes_.end(), nodes.begin(), nodes.end());
    std::ranges::sort(all_nodes_);
  }
  return all_nodes_;
}

void ContactHold::change(std::span<const collision::Contact> contacts, Picoseconds born,
                         std::span<const collision::Touch> touches, const BodyState& body) {
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    Probe& probe = probes_[i];
    if (contacts[i] == contacts_[i] && probe.next_nodes == probe.nodes) continue;
    contacts_[i] = contacts[i];
    probe.nodes = probe.next_nodes;
    const Sight last = probe.sights[0].value_or(Sight{born, touches[i].tip});
    const Sight before = probe.sights[1].value_or(last);
    probe.hand_over.change(probe.nodes, aim(contacts_[i], before), aim(contacts_[i], last),
                           body.displacement, body.velocity);
  }
}

fem::Hold ContactHold::hold(Picoseconds born, std::span<const collision::Touch> touches,
                            Picoseconds period) {
  const double elapsed_s = to_seconds(born - solved_.value_or(born - period));
  const auto of = [&](std::size_t i) {
    return probes_[i].hand_over.hold(aim(contacts_[i], {born, touches[i].tip}), elapsed_s);
  };
  if (probes_.size() == 1) return of(0);
  held_.clear();
  let_go_.clear();
  double elapsed = 0;
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    const fem::Hold hold = of(i);
    const int probe = static_cast<int>(i);
    for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
      held_.push_back({hold.nodes[n], probe, hold.displacement[n]});
    }
    for (const fem::LetGo& gone : hold.let_go) let_go_.push_back({gone.node, gone.share, probe});
    elapsed = hold.elapsed_s;
  }
  return merged(elapsed);
}

// Merges the probes' nodes in ascending order. A node that another probe has taken over is not
// released, and a fading force belongs to the probe that last had the node.
fem::Hold ContactHold::merged(double elapsed_s) {
  std::ranges::sort(held_, {}, &HeldNode::node);
  all_nodes_.clear();
  probe_of_.clear();
  displacement_.clear();
  for (const HeldNode& held : held_) {
    all_nodes_.push_back(held.node);
    probe_of_.push_back(held.probe);
    displacement_.push_back(held.displacement);
  }
  std::ranges::sort(let_go_, [](const fem::LetGo& a, const fem::LetGo& b) {
    return a.node != b.node ? a.node < b.node : a.share > b.share;
  });
  const auto same_node = [](const fem::LetGo& a, const fem::LetGo& b) { return a.node == b.node; };
  let_go_.erase(std::unique(let_go_.begin(), let_go_.end(), same_node), let_go_.end());
  std::erase_if(let_go_,
                [this](const fem::LetGo& gone) { return contains(all_nodes_, gone.node); });
  return {all_nodes_, displacement_, let_go_, elapsed_s, probe_of_};
}

double ContactHold::operations() const {
  double operations = 0;
  for (const Probe& probe : probes_) operations += probe.hand_over.operations();
  return operations;
}

void ContactHold::keep_tips(Picoseconds born, std::span<const collision::Touch> touches) {
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    probes_[i].sights[1] = probes_[i].sights[0];
    probes_[i].sights[0] = Sight{born, touches[i].tip};
  }
}

// The displacement that a contact prescribes, or would prescribe.
collision::Aim ContactHold::aim(const collision::Contact& contact, const Sight& sight) const {
  collision::Aim aim{sight.born, Eigen::Vector3d::Zero()};
  if (contact.present()) {
    aim.displacement = search_.prescribed_displacement(contact, sight.tip);
  }
  return aim;
}

}  // namespace hvp::host
