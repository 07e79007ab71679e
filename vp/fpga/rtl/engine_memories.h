#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vp/fpga/rtl/engine_model.h"

namespace hvp::vp::rtl {

// The vectors in the memories of engine.sv; z only with a preconditioner.
enum class Vector : std::uint8_t { x, r, b, q, previous, z, d };
const char* name(Vector vector);

// The memories of engine.sv as its translation has them, without clocks: for comparisons and for
// faults. Words are signed and as wide as their memory; a word that is changed acts from the next
// edge at which it is read. Nodes, packages and partitions are not checked.
class EngineMemories {
 public:
  // Throws std::logic_error where the translation does not show a memory (engine/memories.vlt).
  EngineMemories(EngineModel& model, const EngineSize& size);

  // Of d there is a copy for each partition, or two; of the other vectors one.
  int copies(Vector vector) const {
    return vector == Vector::d ? size_.partitions * copies_in_partition() : 1;
  }
  int copies_in_partition() const {
    return size_.direction_memory == accel::DirectionMemory::two_copies ? 2 : 1;
  }
  int bits(Vector vector) const { return component(vector, 0, 0, 0).width; }
  std::int32_t word(Vector vector, int node, int component, int copy = 0) const;
  void set_word(Vector vector, int node, int component, std::int32_t word, int copy = 0);
  // The first of `words`, three a node from node 0 on, that the memory does not have; empty if it
  // has all.
  std::optional<std::size_t> mismatch(Vector vector, std::span<const std::int32_t> words,
                                      int copy = 0) const;

  // An entry of the matrix: its row of the package's three, and its column.
  std::int32_t entry(int partition, int package, int row, int column) const;
  void set_entry(int partition, int package, int row, int column, std::int32_t word);

 private:
  // The memory of a component in a lane, or in a bank of d.
  const Cells& component(Vector vector, int copy, int lane, int component) const;
  int lanes(Vector vector) const {
    return vector == Vector::d ? size_.direction_banks : size_.nodes_per_clock;
  }
  const Cells& cells_of(Vector vector, int node, int component, int copy) const {
    return this->component(vector, copy, node % lanes(vector), component);
  }

  const EngineSize& size_;
  std::vector<Cells> vectors_;  // but d: by vector, lane and component
  std::vector<Cells> d_;        // by copy, bank and component
  std::vector<Cells> matrix_;   // by partition and row
};

}  // namespace hvp::vp::rtl
