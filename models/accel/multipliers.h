#pragma once

#include <cstdint>

#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// The mode that accelerator.multiplier_mode names; the device's first one for "auto". Throws
// InputError with that key if the device has none of that name.
const MultiplierMode& multiplier_mode(const Device& device, const Architecture& a);

// The multipliers that a signed product of such words takes. A word is split into pieces of one bit
// less than the multiplier has; the piece with the sign has all its bits.
int multipliers_a_product(const MultiplierMode& mode, int bits, int other_bits);

// The multipliers of the vector unit, each for a product of its own: 21 for two nodes a clock
// (thesis §6.1), and those that the method adds.
std::int64_t vector_multipliers(const MultiplierMode& mode, const Architecture& a,
                                const WordLengths& w);

// All multipliers of the engine, counted as the mode does: PL1·PL2·PL3 for the product with the
// matrix, and vector_multipliers(). In a mode that gives only sums, products of a row are summed in
// the block, and a product of its own takes as many as the device has fewer of those.
std::int64_t multipliers(const Device& device, const Architecture& a, const WordLengths& w);

}  // namespace hvp::accel
