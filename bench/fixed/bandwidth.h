#pragma once

#include <cstddef>
#include <span>

namespace hvp::fixed::bench {

// Reads a buffer once, with sixteen words per instruction if the machine can, and returns a value
// that depends on all of it. The buffer starts at a cache line and its size is a multiple of 256
// bytes.
int read_all(std::span<const std::byte> buffer);

// The bandwidth in bytes per second of reading a buffer of that size repeatedly, from the cache in
// which it fits or from memory. It is measured once for every size, the best of several times.
double read_bandwidth(std::size_t bytes);

}  // namespace hvp::fixed::bench
