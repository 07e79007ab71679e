#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <limits>
#include <vector>

#include <fmt/format.h>

#include "models/accel/cycles.h"
#include "models/accel/operations.h"
#include "tables/pages.h"
#include "tables/pc/crs_product.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

constexpr double kSecondsASize = 0.5;
constexpr double kSecondsABatch = 0.01;
constexpr int kCopies = 120;  // 70 MB, beyond the caches of most processors

// Thesis Table 6.3: averages of Goumas et al. over their matrices.
struct Processor {
  const char* name;
  const char* clock;
  const char* cache;
  double mflops;
};
constexpr std::array<Processor, 3> kThesis = {{{"Woodcrest", "2.6 GHz", "4 MB", 495.53},
                                               {"Netburst", "2.8 GHz", "1 MB", 297.88},
                                               {"Opteron", "1.8 GHz", "1 MB", 273.72}}};

double seconds_of(const CrsMatrix& a, std::vector<double>& x, std::vector<double>& y,
                  int products) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  for (int i = 0; i < products; ++i) {
    a.multiply(x, y);
    // The next product depends on this one in a way that the compiler cannot predict.
    x[0] = y[0] == 0 ? 1.0 : x[0];
  }
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// 2·NNZ operations a product; the fastest batch, since others use the machine too.
double mflops(const CrsMatrix& a) {
  std::vector<double> x(a.rows(), 1.0);
  std::vector<double> y(a.rows());
  int products = 1;
  while (seconds_of(a, x, y, products) < kSecondsABatch) products *= 2;
  double fastest = std::numeric_limits<double>::infinity();
  for (double spent = 0; spent < kSecondsASize;) {
    const double batch = seconds_of(a, x, y, products);
    fastest = std::min(fastest, batch);
    spent += batch;
  }
  return 2e-6 * static_cast<double>(a.nonzeros()) * products / fastest;
}

// A line of /proc/cpuinfo; empty where there is none.
std::string cpu_info(const std::string& key) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with(key) && colon != std::string::npos) return line.substr(colon + 2);
  }
  return {};
}

// The second-level cache of the first core; empty if the system does not report it.
std::string second_level_cache() {
  std::ifstream file("/sys/devices/system/cpu/cpu0/cache/index2/size");
  std::string size;
  file >> size;
  return size;
}

std::string or_unknown(const std::string& text) { return text.empty() ? "unknown" : text; }

}  // namespace

std::string pc_table() {
  const sparse::BlockMatrix stiffness = thesis_stiffness();
  const CrsMatrix one = crs_of(stiffness);
  const accel::Architecture a;
  const accel::Pattern pattern = accel::pattern_of(stiffness.row_begin, stiffness.column);
  const accel::SolveCycles cycles = accel::solve_cycles(a, pattern, {});
  const accel::OperationRate rate = accel::operation_rate(a, pattern, fixed::Method::cg, cycles);
  // Operations are counted as for the processors, two for each non-zero, in the clocks of a
  // product.
  const double useful = 2.0 * static_cast<double>(one.nonzeros()) * a.clock_hz /
                        static_cast<double>(cycles.sparse_product);

  MarkdownTable table({"processor", "clock", "L2 cache", "MFLOPS", "thesis: × slower",
                       "than 36·PL3 a clock", "than 2·24·PL3·useful share"});
  const auto slower = [](double accelerator, double mega) {
    return fmt::format("{:.1f}", accelerator * 1e-6 / mega);
  };
  const std::array<const char*, 3> thesis_slower = {"37", "61", "66"};
  for (std::size_t i = 0; i < kThesis.size(); ++i) {
    const Processor& p = kThesis.at(i);
    table.add({p.name, p.clock, p.cache, fmt::format("{:.2f}", p.mflops), thesis_slower.at(i),
               slower(rate.thesis, p.mflops), slower(useful, p.mflops)});
  }
  const std::string name = or_unknown(cpu_info("model name"));
  const std::string megahertz = cpu_info("cpu MHz");
  const auto add = [&](const char* what, double mega) {
    table.add({name + what, or_unknown(megahertz) + " MHz", or_unknown(second_level_cache()),
               fmt::format("{:.0f}", mega), "", slower(rate.thesis, mega), slower(useful, mega)});
  };
  add(", in the caches", mflops(one));
  add(", from memory", mflops(repeated(one, kCopies)));
  return fmt::format(
             "Sparse matrix by vector, double precision, compressed rows, one thread: {} non-zeros "
             "in {} rows.\nThe accelerator: {:.1f} GOPS by Table 6.1 (36·PL3 a clock), {:.1f} at "
             "most, {:.1f} with a useful share of {:.0f} %.\n\n",
             one.nonzeros(), one.rows(), rate.thesis * 1e-9, rate.peak * 1e-9, useful * 1e-9,
             100 * useful / rate.peak) +
         table.text();
}

}  // namespace hvp::tables
