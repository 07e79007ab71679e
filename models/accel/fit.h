#pragma once

#include <span>
#include <string>
#include <vector>

#include "models/accel/memory.h"

namespace hvp::accel {

// A change of an architecture, written as keys of a scenario.
struct Proposal {
  std::vector<std::string> settings;  // "accelerator.partitions = 3"
  std::string remark;                 // what else has to be done; may be empty
  std::string text() const;
};

// Changes that make a system fit. They are tried in this order: fewer partitions, each structure in
// another memory type, parity bits, another use of the multipliers, symmetric storage; if none of
// these is enough, each of them with as many partitions as then fit; if none of those is, two of
// them; last the first of `others` on which the system fits, with that device's memory types.
std::vector<Proposal> proposals_that_fit(const Device& device, const Architecture& a,
                                         const WordLengths& words, const Pattern& p,
                                         std::span<const Device* const> others);
// The texts of proposals_that_fit().
std::vector<std::string> what_would_fit(const Device& device, const Architecture& a,
                                        const WordLengths& words, const Pattern& p,
                                        std::span<const Device* const> others);

// Throws InputError with what is short and what would fit: fewer nodes, and what_would_fit().
// `mesh_nodes` are the nodes of the system's body if a user states these, otherwise 0.
void require_fit(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p, std::span<const Device* const> others = {}, int mesh_nodes = 0);

}  // namespace hvp::accel
