#include "models/host/processor.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::host {

using config::Dimension;

void Processor::declare(config::Visitor& v) {
  constexpr const char* kSource = "desktop-2026: docs/host-solvers.md";
  const auto rate = [&](std::string_view name, double& value, std::string_view what) {
    v.quantity(name, value, Dimension::throughput, config::between(1e6, 1e14), {what, kSource});
  };
  v.quantity("call", call_s, Dimension::time, config::between(0, 1e-2),
             {"of every solve, whatever it does", kSource});
  rate("dense_rate", dense_flops,
       "operations a second of dense products whose operands are at "
       "hand");
  rate("single_rate", single_flops, "the same in single precision");
  rate("sparse_rate", sparse_flops,
       "operations a second of products with A, and of the host's "
       "other steps");
  rate("triangular_rate", triangular_flops, "operations a second with sparse factors");
  constexpr std::array<const char*, 3> kSizes = {"level1_size", "level2_size", "level3_size"};
  constexpr std::array<const char*, 3> kBandwidths = {"level1_bandwidth", "level2_bandwidth",
                                                      "level3_bandwidth"};
  for (std::size_t i = 0; i < caches.size(); ++i) {
    v.quantity(kSizes[i], caches[i].size_bytes, Dimension::data_size, config::between(0, 1e12),
               {"what this cache has room for", kSource});
    v.quantity(kBandwidths[i], caches[i].bandwidth, Dimension::bandwidth,
               config::between(1e6, 1e14), {"at which one core reads it", kSource});
  }
  v.quantity("memory_bandwidth", memory_bandwidth, Dimension::bandwidth, config::between(1e6, 1e14),
             {"at which one core reads what no cache has room for", kSource});
}

void Processor::check() const {
  for (std::size_t i = 1; i < caches.size(); ++i) {
    if (caches[i].size_bytes >= caches[i - 1].size_bytes) continue;
    throw InputError(fmt::format("level{}_size", i + 1),
                     fmt::format("expected at least level{}_size = {:g} B, found {:g} B", i,
                                 caches[i - 1].size_bytes, caches[i].size_bytes));
  }
}

double Processor::bandwidth(double working_set) const {
  if (!(working_set > 0)) return caches.front().bandwidth;
  double within = 0;    // the share of the working set in the caches so far
  double per_byte = 0;  // s
  for (const Tier& tier : caches) {
    const double share =
        tier.size_bytes > 0 ? std::clamp(2 - working_set / tier.size_bytes, 0.0, 1.0) : 0.0;
    per_byte += std::max(0.0, share - within) / tier.bandwidth;
    within = std::max(within, share);
  }
  return 1 / (per_byte + (1 - within) / memory_bandwidth);
}

double Processor::seconds(const SolveWork& work, double working_set) const {
  if (work.operations() == 0) return 0;
  return std::max(1, work.calls) * call_s + work.dense / dense_flops +
         work.dense_single / single_flops + work.sparse / sparse_flops +
         work.triangular / triangular_flops + work.bytes / bandwidth(working_set);
}

const char* name(ProcessorModel model) {
  switch (model) {
    case ProcessorModel::one_rate:
      return "one-rate";
    case ProcessorModel::thesis_pc:
      return "thesis-pc";
    case ProcessorModel::desktop_2026:
      return "desktop-2026";
    case ProcessorModel::measured:
      return "measured";
  }
  return "";
}

const Processor& built_in(ProcessorModel model) {
  // Pentium D 820, 2.8 GHz: 16 kB and 1 MB a core (Intel 307506), a bus of 6.4 GB/s. Products with
  // sparse matrices: thesis Table 6.3's 297.88 Mflop/s are of matrices that stream from memory, at
  // 4.2 bytes an operation; what is left of an operation's 3.36 ns at 3.5 GB/s takes 2.16 ns.
  // Assumed: 3.5 GB/s of the bus for one reading core, 16 and 8 bytes a clock from the caches at
  // half their peak, half of SSE2's two operations a clock, and substitutions as fast as products.
  static const Processor thesis_pc = {.call_s = 0,
                                      .dense_flops = 2.8e9,
                                      .single_flops = 5.6e9,
                                      .sparse_flops = 463e6,
                                      .triangular_flops = 463e6,
                                      .caches = {{{16e3, 22.4e9}, {1e6, 11.2e9}, {1e6, 11.2e9}}},
                                      .memory_bandwidth = 3.5e9};
  // Measured by `hvp measure host` on one core of an AMD EPYC that others use too; tests/data has
  // the times (host-solves.csv). That a desktop's own core is no slower is assumed. Its dense rate
  // is a bound: the bytes took all of the time.
  static const Processor desktop_2026 = {.call_s = 200e-9,
                                         .dense_flops = 100e9,
                                         .single_flops = 95e9,
                                         .sparse_flops = 6.2e9,
                                         .triangular_flops = 2.6e9,
                                         .caches = {{{32768, 53e9}, {524288, 37e9}, {9.4e6, 51e9}}},
                                         .memory_bandwidth = 12e9};
  switch (model) {
    case ProcessorModel::thesis_pc:
      return thesis_pc;
    case ProcessorModel::desktop_2026:
      return desktop_2026;
    case ProcessorModel::one_rate:
    case ProcessorModel::measured:
      break;
  }
  throw std::logic_error("this model of a host has no figures of its own");
}

}  // namespace hvp::host
