// Where the bits of a flip are in engine.sv.
#include <string>

#include "models/index.h"
#include "vp/fpga/rtl/rtl_engine.h"

namespace hvp::vp::rtl {

namespace {

std::string indexed(const std::string& name, int index) {
  return name + "[" + std::to_string(index) + "]";
}

std::string partition_of(int number) { return indexed("matrix.g_partition", number) + ".spmxv"; }

std::string copy_of(int partition, int component) {
  return partition_of(partition) + "." + indexed("g_component", component) + ".copy";
}

// The memory of one component of a vector in the lane.
std::string bank_of(int lane, int component, const std::string& vector) {
  return "vectors." + indexed("g_lane", lane) + "." + indexed("g_component", component) +
         ".component.bank." + vector + "_memory";
}

constexpr const char* kSequencer = "sequence_of_passes";

}  // namespace

void RtlEngine::flip(const engine::Flip& f) {
  using Place = engine::FlipPlace;
  // An index word is {last, phase, owner, nodes}.
  const int owner = architecture_nodes() * size_.node_bits;
  const auto index = [&](int first_bit) {
    clear_unused();
    model_->flip(partition_of(f.partition), "index", at(f.package), first_bit + f.bit);
  };
  switch (f.place) {
    case Place::x:
    case Place::r:
    case Place::b:
    case Place::q:
    case Place::previous:
      model_->flip(bank_of(f.node % size_.nodes_per_clock, f.component, name(f.place)), "cells",
                   at(f.node / size_.nodes_per_clock), f.bit);
      break;
    case Place::d:
      model_->flip(copy_of(f.partition, f.component), "cells", at(f.node), f.bit);
      break;
    case Place::matrix:
      model_->flip(partition_of(f.partition) + "." + indexed("g_row", f.row), "nonzeros",
                   at(f.package), f.column * size_.matrix_bits + f.bit);
      break;
    case Place::nodes:
      index(f.column * size_.node_bits);
      break;
    case Place::owner:
      index(owner);
      break;
    case Place::phase:
      index(owner + size_.node_bits);
      break;
    case Place::last:
      index(owner + size_.node_bits + 2);
      break;
    case Place::coefficient:
    case Place::r_r:
    case Place::loops:
      model_->flip(kSequencer, name(f.place), 0, f.bit);
      break;
  }
}

void RtlEngine::expect_flips() {
  if (!expects_flips_ && !has_solved_) clear_q();
  expects_flips_ = true;
}

// A row that a flipped index word takes elsewhere leaves its own words of q as they were.
void RtlEngine::clear_q() {
  for (int c = 0; c < 3; ++c) {
    for (int lane = 0; lane < size_.nodes_per_clock; ++lane) {
      model_->clear(bank_of(lane, c, "q"), "cells", 0);
    }
  }
}

// An index word with a flipped bit can point at words that no system has used: they are zero, as a
// device is configured. Only in simulation they begin with random values.
void RtlEngine::clear_unused() {
  for (int c = 0; c < 3; ++c) {
    for (int p = 0; p < size_.partitions; ++p) model_->clear(copy_of(p, c), "cells", at(nodes_));
    for (int lane = 0; lane < size_.nodes_per_clock; ++lane) {
      const int used = (nodes_ - lane + size_.nodes_per_clock - 1) / size_.nodes_per_clock;
      model_->clear(bank_of(lane, c, "b"), "cells", at(used));
    }
  }
}

}  // namespace hvp::vp::rtl
