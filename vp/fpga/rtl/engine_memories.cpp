#include "vp/fpga/rtl/engine_memories.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "models/index.h"

namespace hvp::vp::rtl {

namespace {

// The order of Vector.
constexpr std::array kInstances = {"x_memory", "r_memory",        "b_memory",
                                   "q_memory", "previous_memory", "g_preconditioner.z_memory"};
constexpr int kComponents = 3;

std::string element(const char* array, int index) {
  return std::string(array) + "[" + std::to_string(index) + "]";
}

std::int32_t sign_extended(std::uint32_t word, int bits) {
  const int unused = 32 - bits;
  return static_cast<std::int32_t>(word << unused) >> unused;
}

std::uint32_t mask(int bits) { return static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1); }

// True if the memory has every stride-th of the words from its first address on.
template <class Cell>
bool equal(const Cells& cells, std::span<const std::int32_t> words, std::size_t first,
           std::size_t stride) {
  const std::uint32_t used = mask(cells.width);
  const std::byte* cell = cells.first;
  std::uint32_t differences = 0;
  for (std::size_t i = first; i < words.size(); i += stride, cell += sizeof(Cell)) {
    Cell found;
    std::memcpy(&found, cell, sizeof found);
    differences |= (static_cast<std::uint32_t>(words[i]) & used) ^ found;
  }
  return differences == 0;
}

}  // namespace

const char* name(Vector vector) {
  constexpr std::array kNames = {"x", "r", "b", "q", "the x before", "z", "d"};
  return kNames[static_cast<std::size_t>(vector)];
}

std::uint32_t Cells::bits(int index, int low, int length) const {
  std::uint64_t part = 0;
  const int begin = low / 8;
  const auto size = std::min(sizeof part, at(bytes - begin));
  std::memcpy(&part, &first[at(index * bytes + begin)], size);
  return static_cast<std::uint32_t>(part >> (low % 8)) & mask(length);
}

void Cells::set_bits(int index, int low, int length, std::uint32_t value) const {
  for (int i = 0; i < length; ++i) {
    const int bit = low + i;
    std::byte& part = first[at(index * bytes + bit / 8)];
    const auto one = std::byte{1} << (bit % 8);
    part = (value >> i & 1U) != 0 ? part | one : part & ~one;
  }
}

EngineMemories::EngineMemories(EngineModel& model, const EngineSize& size) : size_(size) {
  for (std::size_t i = 0; i < kInstances.size(); ++i) {
    if (i == static_cast<std::size_t>(Vector::z) && size.preconditioner == Preconditioner::none) {
      continue;
    }
    const char* instance = kInstances[i];
    for (int lane = 0; lane < size.nodes_per_clock; ++lane) {
      for (int c = 0; c < kComponents; ++c) {
        vectors_.push_back(model.cells("vectors." + element("g_lane", lane) + "." +
                                           element("g_component", c) + ".component.bank." +
                                           instance,
                                       "cells"));
      }
    }
  }
  for (int p = 0; p < size.partitions; ++p) {
    const std::string partition = "matrix." + element("g_partition", p) + ".spmxv.";
    for (int i = 0; i < kComponents; ++i) {
      matrix_.push_back(model.cells(partition + element("g_row", i), "nonzeros"));
    }
    const bool pumped = size.direction_memory == accel::DirectionMemory::double_pumped;
    for (int copy = 0; copy < copies_in_partition(); ++copy) {
      const std::string memory = pumped ? "g_double_pumped.memory"
                                        : "g_dual_port." + element("g_memory", copy) + ".memory";
      for (int bank = 0; bank < size.direction_banks; ++bank) {
        for (int i = 0; i < kComponents; ++i) {
          std::string instance = partition;
          instance.append(element("g_component", i)).append(".copy.");
          instance.append(element("g_bank", bank)).append(".bank.").append(memory);
          d_.push_back(model.cells(instance, "cells"));
        }
      }
    }
  }
}

const Cells& EngineMemories::component(Vector vector, int copy, int lane, int component) const {
  if (vector == Vector::d) {
    return d_[at(kComponents * (copy * size_.direction_banks + lane) + component)];
  }
  const auto first = static_cast<int>(vector) * size_.nodes_per_clock;
  return vectors_[at(kComponents * (first + lane) + component)];
}

std::int32_t EngineMemories::word(Vector vector, int node, int component, int copy) const {
  const Cells& cells = cells_of(vector, node, component, copy);
  return sign_extended(cells.bits(node / lanes(vector), 0, cells.width), cells.width);
}

void EngineMemories::set_word(Vector vector, int node, int component, std::int32_t word, int copy) {
  Cells cells = cells_of(vector, node, component, copy);
  cells.set_bits(node / lanes(vector), 0, cells.width, static_cast<std::uint32_t>(word));
}

std::optional<std::size_t> EngineMemories::mismatch(Vector vector,
                                                    std::span<const std::int32_t> words,
                                                    int copy) const {
  bool same = true;
  const int step = lanes(vector);
  for (int lane = 0; lane < step; ++lane) {
    for (int c = 0; c < kComponents; ++c) {
      const Cells& cells = component(vector, copy, lane, c);
      const auto first = at(kComponents * lane + c);
      const auto stride = at(kComponents * step);
      same = same && (cells.bytes == sizeof(std::uint16_t)
                          ? equal<std::uint16_t>(cells, words, first, stride)
                          : equal<std::uint32_t>(cells, words, first, stride));
    }
  }
  if (same) return std::nullopt;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto node = static_cast<int>(i) / kComponents;
    if (word(vector, node, static_cast<int>(i) % kComponents, copy) != words[i]) return i;
  }
  // A word of the model has more bits than its memory; both have the same below.
  return std::nullopt;
}

std::int32_t EngineMemories::entry(int partition, int package, int row, int column) const {
  const Cells& rows = matrix_[at(kComponents * partition + row)];
  const int bits = size_.matrix_bits;
  return sign_extended(rows.bits(package, bits * column, bits), bits);
}

void EngineMemories::set_entry(int partition, int package, int row, int column, std::int32_t word) {
  Cells rows = matrix_[at(kComponents * partition + row)];
  rows.set_bits(package, size_.matrix_bits * column, size_.matrix_bits,
                static_cast<std::uint32_t>(word));
}

}  // namespace hvp::vp::rtl
