#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "models/fem/material.h"

namespace hvp::fem {

// What each element of a body is made of: a table of materials, and an index into it for each
// element. Where the index is empty, every element is of the table's first material.
//
// Sums over elements go through them in one order whatever the materials are, so that a body whose
// materials are equal has the bits of a body of one material.
class Materials {
 public:
  // Of the default material.
  Materials() : Materials(Material{}) {}
  // A body of one material is one.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Materials(const Material& everywhere) : table_{everywhere} {}
  // `of_element` has an index into `table` for each tetrahedron of a mesh. Throws
  // std::invalid_argument for an empty table or an index that is not into it.
  Materials(std::vector<Material> table, std::vector<int> of_element);

  std::size_t count() const { return table_.size(); }
  std::span<const Material> table() const { return table_; }
  std::size_t index_of(std::size_t element) const {
    return of_element_.empty() ? 0 : static_cast<std::size_t>(of_element_[element]);
  }
  // The index of each element; empty where every element is of the first material.
  std::span<const int> of_elements() const { return of_element_; }
  const Material& of(std::size_t element) const { return table_[index_of(element)]; }

  // Throws InputError naming the parameter of a material that is not finite or out of range, and
  // std::invalid_argument for another number of elements than a mesh has.
  void check(std::size_t elements) const;

 private:
  std::vector<Material> table_;
  std::vector<int> of_element_;
};

// Lamé's constants of each material of the table (Pa).
struct Lame {
  double lambda = 0;
  double mu = 0;
};
std::vector<Lame> lame_constants(std::span<const Material> table);

}  // namespace hvp::fem
