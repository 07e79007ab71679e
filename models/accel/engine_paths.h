#pragma once

#include <array>
#include <functional>
#include <string_view>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/critical_path.h"
#include "models/accel/device.h"
#include "models/accel/path_builder.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// The operations of the vector unit on a word behind its first multipliers. A register can stand
// between any two of them.
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

// The bits by which a row's sum is wider than a product: 48 bits in all for 12 and 16,
// where engine.sv has 38 for 1024 nodes.
inline constexpr int kRowGrowthBits = 20;

// The bits of a magnitude that a multiplier takes; words of sign and magnitude are multiplied
// (thesis §5.5). The 32 bits of A·d are taken in halves (Fig. 5.10), vector words as a whole unless
// they are wider than a multiplier.
int magnitude_bits(const MultiplierMode& multiplier, const WordLengths& words);

// The stages of group a, in which a row's sum becomes a word of A·d and part of dᵀA·d.
VectorStages product_stages(const Architecture& a, const WordLengths& words,
                            const MultiplierMode& multiplier);
// The stages of group b, the longest pass: α·q is aligned, r and, with a preconditioner, z are
// written and multiplied.
VectorStages update_stages(const Architecture& a, const WordLengths& words,
                           const MultiplierMode& multiplier);

// Distributes the stages over `ranks` ranks of registers, the longest rank as short as possible,
// and gives the path of each rank to `take`.
void each_rank(const VectorStages& stages, int ranks, PathBuilder& path,
               const std::function<void(const Path&)>& take);

// Gives `take` every kind of path between two registers of the configured engine: the SpMxV
// sub-blocks of thesis Fig. 5.5, the vector unit, the divider, host access, and the
// limits of the blocks. A path is valid until the next one is given. The device has to have delays.
void each_path(const Clocking& c, const std::function<void(const Path&)>& take);

}  // namespace hvp::accel
