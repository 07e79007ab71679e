#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "models/collision/contact_search.h"
#include "models/collision/hand_over.h"
#include "models/fem/body.h"
#include "models/host/frame_computation.h"
#include "models/time/picoseconds.h"

namespace hvp::vp {

// Where the tip was read to be.
struct Sight {
  Picoseconds born = 0;  // of the frame
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
};

// The contact that the frames are solved with, and where it holds its nodes while it follows the
// tip and is handed over to the next one.
class ContactHold {
 public:
  // Keeps references.
  ContactHold(const fem::Body& body, host::FrameComputation& computation,
              const collision::ContactSearch& contacts);

  const collision::Contact& contact() const { return contact_; }
  // The active nodes that a contact holds, ascending; until the next call.
  std::span<const int> nodes_of(const collision::Contact& contact);
  // From this frame on it is that contact, whose nodes were asked for last.
  void change(const collision::Contact& contact, const Sight& now);
  // Prescribes the frame's displacements. Returns the operations that this takes.
  double prescribe(const Sight& now, Picoseconds period);
  // At the end of the frame's preparation.
  void remember(const Sight& now);
  // U and the state of the time integration are those of the frame that was born then.
  void updated(Picoseconds born) { updated_ = born; }

 private:
  collision::Aim aim_at(const Sight& sight) const;

  const fem::Body& body_;
  host::FrameComputation& computation_;
  const collision::ContactSearch& contacts_;
  collision::HandOver hand_over_;
  collision::Contact contact_;
  std::vector<int> nodes_;
  std::array<std::optional<Sight>, 2> sights_;  // of the two frames before, the last one first
  std::optional<Picoseconds> updated_;
};

}  // namespace hvp::vp
