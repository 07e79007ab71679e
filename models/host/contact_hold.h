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

// What a body does on its own, as change() needs it: of active nodes, m and m/s; `velocity` is
// empty for a body without mass.
struct BodyState {
  std::span<const double> displacement;
  std::span<const double> velocity;
};

// The contacts that frames are solved with, one for each probe, and where they hold their nodes
// while these follow the tips and are handed over to the next contact. The servo process' order:
//
//   change(contacts, …)  where they are others than contacts();  hold(…);  keep_tips(…);
//   …the frame is solved…  solved(…);
class ContactHold {
 public:
  // Keeps references.
  ContactHold(const fem::Body& body, const collision::ContactSearch& contacts,
              Picoseconds hand_over, std::size_t probes = 1);

  std::span<const collision::Contact> contacts() const { return contacts_; }
  // The active nodes that these contacts hold, ascending; a node that two of them want is the
  // earlier one's. Until the next call.
  std::span<const int> nodes_of(std::span<const collision::Contact> contacts);
  // From the frame that is born then on they are these, whose nodes were asked for last.
  void change(std::span<const collision::Contact> contacts, Picoseconds born,
              std::span<const collision::Touch> touches, const BodyState& body);
  // What they prescribe in the frame; until the next call. Only the touches' tips are looked at.
  fem::Hold hold(Picoseconds born, std::span<const collision::Touch> touches, Picoseconds period);
  // Additions and multiplications of the last hold().
  double operations() const;
  // At the end of the frame's preparation.
  void keep_tips(Picoseconds born, std::span<const collision::Touch> touches);
  // The body's state is that of the frame that was born then.
  void solved(Picoseconds born) { solved_ = born; }

 private:
  struct Sight {
    Picoseconds born;
    Eigen::Vector3d tip;
  };
  struct Probe {
    collision::HandOver hand_over;
    std::vector<int> nodes;
    std::vector<int> next_nodes;                 // of the contacts that were asked for last
    std::array<std::optional<Sight>, 2> sights;  // of the two frames before, the last one first
  };

  collision::Aim aim(const collision::Contact& contact, const Sight& sight) const;
  fem::Hold merged(double elapsed_s);

  const fem::Body& body_;
  const collision::ContactSearch& search_;
  std::vector<Probe> probes_;
  std::vector<collision::Contact> contacts_;
  std::optional<Picoseconds> solved_;
  // Of several probes together.
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
