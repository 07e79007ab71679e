#pragma once

#include <array>
#include <functional>
#include <string_view>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/accel/path_builder.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// What the vector unit does with a word behind its first multipliers, in steps between which a
// register can stand.
enum class Operation { multiplexer, shifter, saturation, absolute_value, adder, multiplier };

struct Step {
  Operation operation = Operation::adder;
  int size = 0;  // ways of a multiplexer, otherwise bits
};

struct VectorStage {
  std::string_view name;
  std::array<Step, 3> steps{};
  int count = 0;
};
using VectorStages = std::vector<VectorStage>;

// Bits by which a row's sum is wider than a product: 48 bits for 12 and 16 (spmxv.sv).
inline constexpr int kRowGrowthBits = 20;

// Words of sign and magnitude are multiplied (thesis §5.5). The 32 bits of A·d are taken in halves
// (Fig. 5.10), vector words as a whole unless they are wider than a multiplier.
int magnitude_bits(const MultiplierMode& multiplier, const WordLengths& words);

// Group a: a row's sum becomes a word of A·d and part of dᵀA·d.
VectorStages product_stages(const Architecture& a, const WordLengths& words,
                            const MultiplierMode& multiplier);
// Group b, the longest of the passes: α·q is aligned, r and, with a preconditioner, z are written
// and multiplied.
VectorStages update_stages(const Architecture& a, const WordLengths& words,
                           const MultiplierMode& multiplier);

// The stages over so many ranks of registers, with the longest rank as short as it can be.
void each_rank(const VectorStages& stages, int ranks, PathBuilder& path,
               const std::function<void(const Path&)>& take);

}  // namespace hvp::accel
