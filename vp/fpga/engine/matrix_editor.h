#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <systemc>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"
#include "vp/fpga/engine/layout.h"
#include "vp/fpga/engine/spmxv_block.h"

namespace hvp::vp::engine {

// The unit that clears and restores the row and the column of a contact node (thesis §3.7, §6.2.1),
// one package a clock: first those of the node's own row, then those of each neighbour's row, in
// which the index memory is searched for the node's column. Then the pipelines run empty and, with
// a preconditioner, the divider makes the node's part of P⁻¹, or that of all nodes after a load.
class MatrixEditor : public sc_core::sc_module {
 public:
  MatrixEditor(const sc_core::sc_module_name& name, const accel::Architecture& architecture,
               std::vector<std::unique_ptr<SpmxvBlock>>& blocks);

  std::function<void()> finished;

  // `contact` says which nodes are contact nodes.
  void load(const Layout& layout, const std::vector<std::uint8_t>& contact);
  // Clears the row and the column of a node but for `diagonal`.
  void constrain(int node, std::int32_t diagonal, const fixed::Settings& settings);
  // Restores the node's row and column. `row` has nine words for each block of the row, in the
  // order of its pattern. Blocks shared with another contact node stay cleared.
  void restore(int node, std::span<const std::int32_t> row, const fixed::Settings& settings);
  // Makes P⁻¹ of all nodes.
  void invert_all(const fixed::Settings& settings);
  void clocked();
  void abort() { busy_ = false; }
  // True if all packages are written and the pipelines are empty with the next edge.
  bool at_last_edge() const { return next_visit_ == visits_.size() && drain_ <= 1; }
  void finish();

  bool is_contact(int node) const { return contact_[static_cast<std::size_t>(node)] != 0; }
  bool busy() const { return busy_; }
  // The node whose row and column are or were changed last.
  int node() const { return node_; }
  // The number of edges of the last command: its packages, then the pipelines and the divisions.
  std::int64_t edges() const { return edges_; }

 private:
  // A package that the editor has to read.
  struct Visit {
    int row = 0;
    int package = 0;      // its index in the partition
    int first_block = 0;  // the row's block of the package's first column
  };

  void begin(int node, const fixed::Settings& settings);
  void visit(const Visit& visit);
  std::int32_t word(const Visit& visit, int block_column, int row, int column) const;

  const accel::Architecture& architecture_;
  std::vector<std::unique_ptr<SpmxvBlock>>& blocks_;
  const Layout* layout_ = nullptr;
  std::vector<std::uint8_t> contact_;  // one bit for each node

  bool busy_ = false;
  bool restoring_ = false;
  int node_ = 0;
  std::int32_t diagonal_ = 0;
  std::vector<std::int32_t> staged_;  // the row that the host sent
  std::vector<int> staged_block_of_;  // each node's block in that row, or -1
  std::vector<Visit> visits_;
  std::size_t next_visit_ = 0;
  std::int64_t edges_ = 0;
  std::int64_t drain_ = 0;  // edges until the pipelines are empty and the divider is done
};

}  // namespace hvp::vp::engine
