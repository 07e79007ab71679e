#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <systemc>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"
#include "vp/fpga/engine/engine_clock.h"
#include "vp/fpga/engine/layout.h"
#include "vp/fpga/engine/spmxv_block.h"

namespace hvp::vp::engine {

// Clears and restores the row and the column of a contact node (thesis §3.7, §6.2.1), a package a
// clock: first those of the node's own row, then those of each neighbour's row, which are searched
// for the node's column by what the index memory says. Then the pipelines run empty and, with a
// preconditioner, the divider makes the node's part of P⁻¹, or that of all nodes after a load.
class MatrixEditor : public sc_core::sc_module {
 public:
  MatrixEditor(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
               EngineClock& clock, std::vector<std::unique_ptr<SpmxvBlock>>& blocks);

  std::function<void()> finished;

  // `contact` says which nodes are contact nodes.
  void load(const Layout& layout, const std::vector<std::uint8_t>& contact);
  // The row and the column of a node are cleared but for `diagonal`.
  void constrain(int node, std::int32_t diagonal, fixed::Method method);
  // `row` has the words of the node's row, nine a block in the order of its pattern. Blocks shared
  // with a node that is a contact node now stay cleared.
  void restore(int node, std::span<const std::int32_t> row, fixed::Method method);
  // P⁻¹ of all nodes.
  void invert_all(fixed::Method method);
  void abort() { busy_ = false; }
  // Everything is written, and the pipelines are empty with the next edge.
  bool at_last_edge() const { return next_visit_ == visits_.size() && drain_ <= 1; }
  void finish();

  bool is_contact(int node) const { return contact_[static_cast<std::size_t>(node)] != 0; }
  bool busy() const { return busy_; }
  // The node whose row and column are changed, or were last.
  int node() const { return node_; }
  // Edges of the command that was given last: its packages, then the pipelines and the divisions.
  std::int64_t edges() const { return edges_; }

 private:
  // A package of a row that has to be looked at.
  struct Visit {
    int row = 0;
    int package = 0;      // of its partition
    int first_block = 0;  // of the row, that its first column belongs to
  };

  void begin(int node, fixed::Method method);
  void clocked();
  void visit(const Visit& visit);
  std::int32_t word(const Visit& visit, int block_column, int row, int column) const;

  const accel::Architecture& architecture_;
  EngineClock& clock_;
  std::vector<std::unique_ptr<SpmxvBlock>>& blocks_;
  const Layout* layout_ = nullptr;
  std::vector<std::uint8_t> contact_;  // a bit a node

  bool busy_ = false;
  bool restoring_ = false;
  int node_ = 0;
  std::int32_t diagonal_ = 0;
  std::vector<std::int32_t> staged_;  // the row that the host sent
  std::vector<int> staged_block_of_;  // a node each: its block in that row, or -1
  std::vector<Visit> visits_;
  std::size_t next_visit_ = 0;
  std::int64_t edges_ = 0;
  std::int64_t drain_ = 0;  // edges until the pipelines are empty and the divider is done
};

}  // namespace hvp::vp::engine
