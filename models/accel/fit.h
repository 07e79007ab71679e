#pragma once

#include <span>
#include <string>
#include <vector>

#include "models/accel/memory.h"

namespace hvp::accel {

// A change of an architecture, as a scenario's keys.
struct Proposal {
  std::vector<std::string> settings;  // "accelerator.partitions = 3"
  std::string remark;                 // what else has to be done; empty: nothing
  std::string text() const;
};

// Changes that make a system fit. Tried in this
// order: fewer partitions, each structure in another memory type, parity bits, another use of the
// multipliers, symmetric storage; where none of those is enough, each of them with as few fewer
// partitions as it takes; where none of those is, two of them; then the first of `others`, with its
// own memory types, that holds it.
std::vector<Proposal> proposals_that_fit(const Device& device, const Architecture& a,
                                         const WordLengths& words, const Pattern& p,
                                         std::span<const Device* const> others);
// Their texts.
std::vector<std::string> what_would_fit(const Device& device, const Architecture& a,
                                        const WordLengths& words, const Pattern& p,
                                        std::span<const Device* const> others);

// Throws InputError with what is short and what would fit: fewer nodes, and what_would_fit().
// `mesh_nodes` are those of the body that the system is of, where a user states these.
void require_fit(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p, std::span<const Device* const> others = {}, int mesh_nodes = 0);

}  // namespace hvp::accel
