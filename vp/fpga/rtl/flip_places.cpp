// Where the bits of a flip are in engine.sv.
#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/index.h"
#include "vp/fpga/rtl/rtl_engine.h"

namespace hvp::vp::rtl {

namespace {

std::string indexed(const std::string& name, int index) {
  return name + "[" + std::to_string(index) + "]";
}

std::string partition_of(int number) { return indexed("matrix.g_partition", number) + ".spmxv"; }

// The memory of one component of a vector in the lane.
std::string bank_of(int lane, int component, const std::string& vector) {
  return "vectors." + indexed("g_lane", lane) + "." + indexed("g_component", component) +
         ".component.bank." + vector + "_memory";
}

constexpr const char* kSequencer = "sequence_of_passes";

void flip_bit(Cells cells, int entry, int bit) {
  cells.set_bits(entry, bit, 1, cells.bits(entry, bit, 1) ^ 1U);
}

// A word of so many bits in a memory that may be wider: the bits beyond repeat its sign.
void flip_residual(Cells cells, int entry, int bit, int bits) {
  const int count = bit == bits - 1 ? cells.width - bit : 1;
  const std::uint32_t all = ~std::uint32_t{0} >> (32 - count);
  cells.set_bits(entry, bit, count, cells.bits(entry, bit, count) ^ all);
}

// From this entry on.
void clear(Cells cells, int first) {
  std::fill_n(cells.first + at(first) * at(cells.bytes), at(cells.count - first) * at(cells.bytes),
              std::byte{0});
}

}  // namespace

void RtlEngine::flip(const engine::Flip& f) {
  using Place = engine::FlipPlace;
  // An index word is {last, phase, owner, nodes}.
  const int owner = nodes_in_package() * size_.node_bits;
  const auto change = [&](const std::string& instance, const char* variable, int entry, int bit) {
    flip_bit(model_->cells(instance, variable), entry, bit);
  };
  const auto index = [&](int first_bit) {
    clear_unused();
    flip_index(f.partition, f.package, first_bit + f.bit);
  };
  switch (f.place) {
    case Place::x:
    case Place::q:
    case Place::previous:
      change(bank_of(f.node % size_.nodes_per_clock, f.component, name(f.place)), "cells",
             f.node / size_.nodes_per_clock, f.bit);
      break;
    case Place::z:
      change(bank_of(f.node % size_.nodes_per_clock, f.component, "g_preconditioner.z"), "cells",
             f.node / size_.nodes_per_clock, f.bit);
      break;
    case Place::inverse: {
      // Of its row of a block: the word on the diagonal.
      const int word = size_.preconditioner == Preconditioner::blocks ? f.component : 0;
      change(bank_of(f.node % size_.nodes_per_clock, f.component,
                     "g_preconditioner." + indexed("g_word", word) + ".inverse"),
             "cells", f.node / size_.nodes_per_clock, f.bit);
      break;
    }
    case Place::r:
    case Place::b:
      flip_residual(
          model_->cells(bank_of(f.node % size_.nodes_per_clock, f.component, name(f.place)),
                        "cells"),
          f.node / size_.nodes_per_clock, f.bit, settings_.residual_bits());
      break;
    case Place::d: {
      const int copy = memories_.copies_in_partition() * f.partition + f.copy;
      const auto word = engine::flipped(memories_.word(Vector::d, f.node, f.component, copy), f.bit,
                                        size_.vector_bits);
      memories_.set_word(Vector::d, f.node, f.component, static_cast<std::int32_t>(word), copy);
      break;
    }
    case Place::matrix:
      change(partition_of(f.partition) + "." + indexed("g_row", f.row), "nonzeros", f.package,
             f.column * size_.matrix_bits + f.bit);
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
    case Place::r_r:
      change(kSequencer, "z_r", 0, f.bit);
      break;
    case Place::coefficient:
    case Place::loops:
    case Place::r_exponent:
    case Place::d_exponent:
      change(kSequencer, name(f.place), 0, f.bit);
      break;
  }
}

// The word and what the prefetch has of it: the first register has that of the package at
// `position`, if it is full, and behind it come the second one and what the memory shows.
void RtlEngine::flip_index(int partition, int package, int bit) {
  const std::string prefetch = partition_of(partition) + ".index";
  const auto value = [](const Cells& cells) { return cells.bits(0, 0, cells.width); };
  flip_bit(model_->cells(prefetch, "cells"), package, bit);
  const std::uint32_t full = value(model_->cells(prefetch, "full"));
  const bool reads = value(model_->cells(prefetch, "read_valid")) != 0;
  const std::pair<const char*, bool> registers[] = {
      {"first", (full & 1U) != 0}, {"second", (full & 2U) != 0}, {"read", reads}};
  auto held = static_cast<int>(value(model_->cells(partition_of(partition), "position")));
  for (const auto& [name, holds] : registers) {
    if (!holds) continue;
    if (held == package) flip_bit(model_->cells(prefetch, name), 0, bit);
    held = held + 1 == packages_[at(partition)] ? 0 : held + 1;
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
      clear(model_->cells(bank_of(lane, c, "q"), "cells"), 0);
    }
  }
}

// An index word with a flipped bit can point at words that no system has used: they are zero, as a
// device is configured. Only in simulation they begin with random values.
void RtlEngine::clear_unused() {
  for (int c = 0; c < 3; ++c) {
    for (int copy = 0; copy < memories_.copies(Vector::d); ++copy) {
      for (int node = nodes_; node < 1 << size_.node_bits; ++node) {
        memories_.set_word(Vector::d, node, c, 0, copy);
      }
    }
    for (int lane = 0; lane < size_.nodes_per_clock; ++lane) {
      const int used = (nodes_ - lane + size_.nodes_per_clock - 1) / size_.nodes_per_clock;
      clear(model_->cells(bank_of(lane, c, "b"), "cells"), used);
    }
  }
}

}  // namespace hvp::vp::rtl
