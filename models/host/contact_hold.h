#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "models/collision/contact_search.h"
#include "models/collision/hand_over.h"
#include "models/fem/body.h"
#include "models/fem/hold.h"
#include "models/time/picoseconds.h"

namespace hvp::host {

// The motion of a body as change() needs it: displacement (m) and velocity (m/s) of active nodes;
// `velocity` is empty for a body without mass.
struct BodyState {
  std::span<const double> displacement;
  std::span<const double> velocity;
};

// The contacts of the frames, one for each probe, and the displacements that they prescribe while
// their nodes follow the tips and are handed over to the next contact. The servo process calls, in
// this order:
//
//   change(contacts, …)  where they differ from contacts();  hold(…);  keep_tips(…);
//   …the frame is solved…  solved(…);
class ContactHold {
 public:
  // Keeps references.
  ContactHold(const fem::Body& body, const collision::ContactSearch& contacts,
              Picoseconds hand_over, std::size_t probes = 1);

  std::span<const collision::Contact> contacts() const { return contacts_; }
  // The active nodes whose displacements these contacts prescribe, ascending; a node of two
  // contacts belongs to the earlier one. Valid until the next call.
  std::span<const int> nodes_of(std::span<const collision::Contact> contacts);
  // Makes these the contacts from the frame that is born then. They are those that nodes_of() was
  // last called with.
  void change(std::span<const collision::Contact> contacts, Picoseconds born,
              std::span<const collision::Touch> touches, const BodyState& body);
  // The displacements that the contacts prescribe in the frame; valid until the next call. Only the
  // touches' tips are read.
  fem::Hold hold(Picoseconds born, std::span<const collision::Touch> touches, Picoseconds period);
  // Additions and multiplications of the last hold().
  double operations() const;
  // Stores the tips, at the end of the frame's preparation.
  void keep_tips(Picoseconds born, std::span<const collision::Touch> touches);
  // Says that the body's state is now that of the frame that was born then.
  void solved(Picoseconds born) { solved_ = born; }

 private:
  struct Sight {
    Picoseconds born;
    Eigen::Vector3d tip;
  };
  struct Probe {
    collision::HandOver hand_over;
    std::vector<int> nodes;
    std::vector<int> next_nodes;                 // of the contacts in the last call of nodes_of()
    std::array<std::optional<Sight>, 2> sights;  // of the two frames before, the last one first
  };

  collision::Aim aim(const collision::Contact& contact, const Sight& sight) const;
  fem::Hold merged(double elapsed_s);

  const fem::Body& body_;
  const collision::ContactSearch& search_;
  std::vector<Probe> probes_;
  std::vector<collision::Contact> contacts_;
  std::optional<Picoseconds> solved_;
  // The contact nodes of several probes together.
  struct HeldNode {
    int node;
    int probe;
    Eigen::Vector3d displacement;
  };
  std::vector<HeldNode> held_;
  std::vector<int> all_nodes_;
  std::vector<int> probe_of_;
  std::vector<Eigen::Vector3d> displacement_;
  std::vector<fem::LetGo> let_go_;
};

}  // namespace hvp::host
