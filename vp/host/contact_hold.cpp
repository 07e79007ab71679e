#include "vp/host/contact_hold.h"

namespace hvp::vp {

ContactHold::ContactHold(const fem::Body& body, host::FrameComputation& computation,
                         const collision::ContactSearch& contacts)
    : body_(body),
      computation_(computation),
      contacts_(contacts),
      hand_over_(to_picoseconds(contacts.settings().hand_over_s)) {}

std::span<const int> ContactHold::nodes_of(const collision::Contact& contact) {
  nodes_.clear();
  if (contact.present()) {
    for (const int node : contacts_.patch(contact.node)) {
      nodes_.push_back(body_.active_index(node));
    }
  }
  return nodes_;
}

void ContactHold::change(const collision::Contact& contact, const Sight& now) {
  contact_ = contact;
  const Sight last = sights_[0].value_or(now);
  hand_over_.change(nodes_, aim_at(sights_[1].value_or(last)), aim_at(last),
                    computation_.displacement(), computation_.velocity());
}

double ContactHold::prescribe(const Sight& now, Picoseconds period) {
  const Picoseconds since = updated_.value_or(now.born - period);
  computation_.hold(hand_over_.hold(aim_at(now), to_seconds(now.born - since)));
  return hand_over_.operations() + computation_.hold_operations();
}

void ContactHold::remember(const Sight& now) {
  sights_[1] = sights_[0];
  sights_[0] = now;
}

// Where the present contact wanted its nodes, or would have.
collision::Aim ContactHold::aim_at(const Sight& sight) const {
  collision::Aim aim{sight.born, Eigen::Vector3d::Zero()};
  if (contact_.present()) {
    aim.displacement = contacts_.prescribed_displacement(contact_, sight.tip);
  }
  return aim;
}

}  // namespace hvp::vp
