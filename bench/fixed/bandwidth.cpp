#include "bench/fixed/bandwidth.h"

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <map>

#include <benchmark/benchmark.h>

#include "models/fixed/fast/packed_matrix.h"

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace hvp::fixed::bench {

namespace {

using Words = std::span<const std::int32_t>;

int read_plainly(Words words) {
  int sum = 0;
  for (const std::int32_t word : words) sum ^= word;
  return sum;
}

#ifdef __x86_64__
__attribute__((target("avx512f"))) int read_lines(Words words) {
  __m512i sum[4] = {};
  for (std::size_t i = 0; i < words.size(); i += 64) {
    for (std::size_t k = 0; k < 4; ++k) {
      sum[k] = _mm512_xor_si512(sum[k], _mm512_load_si512(words.data() + i + 16 * k));
    }
  }
  const __m512i all =
      _mm512_xor_si512(_mm512_xor_si512(sum[0], sum[1]), _mm512_xor_si512(sum[2], sum[3]));
  alignas(64) std::int32_t part[16];
  _mm512_store_si512(part, all);
  return read_plainly(part);
}

__attribute__((target("avx2"))) int read_half_lines(Words words) {
  __m256i sum[4] = {};
  for (std::size_t i = 0; i < words.size(); i += 32) {
    for (std::size_t k = 0; k < 4; ++k) {
      const auto* from = reinterpret_cast<const __m256i*>(words.data() + i + 8 * k);
      sum[k] = _mm256_xor_si256(sum[k], _mm256_load_si256(from));
    }
  }
  const __m256i all =
      _mm256_xor_si256(_mm256_xor_si256(sum[0], sum[1]), _mm256_xor_si256(sum[2], sum[3]));
  alignas(32) std::int32_t part[8];
  _mm256_store_si256(reinterpret_cast<__m256i*>(part), all);
  return read_plainly(part);
}
#endif

// Processor time, as for the benchmarks' rates, so that other programs do not count.
double seconds_of(std::span<const std::byte> buffer, int times) {
  const std::clock_t start = std::clock();
  for (int i = 0; i < times; ++i) benchmark::DoNotOptimize(read_all(buffer));
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

}  // namespace

int read_all(std::span<const std::byte> buffer) {
  const Words words(reinterpret_cast<const std::int32_t*>(buffer.data()),
                    buffer.size() / sizeof(std::int32_t));
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") != 0) return read_lines(words);
  if (__builtin_cpu_supports("avx2") != 0) return read_half_lines(words);
#endif
  return read_plainly(words);
}

double read_bandwidth(std::size_t bytes) {
  static std::map<std::size_t, double> measured;
  constexpr std::size_t kUnit = 256;
  const std::size_t size = (bytes + kUnit - 1) / kUnit * kUnit;
  const auto hit = measured.find(size);
  if (hit != measured.end()) return hit->second;
  const fast::Aligned<std::byte> buffer(size, std::byte{1});
  constexpr std::size_t kBytesATime = std::size_t{1} << 28;
  const int times = static_cast<int>(std::max<std::size_t>(1, kBytesATime / size));
  double best = 0;
  for (int trial = 0; trial < 5; ++trial) {
    const double bytes_read = static_cast<double>(size) * times;
    best = std::max(best, bytes_read / seconds_of(buffer, times));
  }
  return measured[size] = best;
}

}  // namespace hvp::fixed::bench
