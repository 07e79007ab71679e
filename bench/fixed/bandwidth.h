#pragma once

#include <cstddef>
#include <span>

namespace hvp::fixed::bench {

// Reads a buffer once, sixteen words an instruction where the machine can, and returns something
// that depends on all of it. The buffer starts at a cache line and is a multiple of 256 bytes.
int read_all(std::span<const std::byte> buffer);

// Bytes a second of reading so many bytes over and over: of the cache that they fit in, or of
// memory. Measured once for every size, the best of several times.
double read_bandwidth(std::size_t bytes);

}  // namespace hvp::fixed::bench
