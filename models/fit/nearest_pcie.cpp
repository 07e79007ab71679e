#include "models/fit/nearest_pcie.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace hvp::fit {

namespace {

using link::Pcie;
using link::PcieGeneration;
using link::PcieSide;

// What [bus.pcie] admits.
constexpr std::array kGenerations = {PcieGeneration::gen1, PcieGeneration::gen2,
                                     PcieGeneration::gen3, PcieGeneration::gen4,
                                     PcieGeneration::gen5};
constexpr std::array kLanes = {1, 2, 4, 8, 16};
constexpr std::array kPayloads = {128, 256, 512};
constexpr int kMostReads = 256;
constexpr double kLongestLatency = 1e-3;  // s

constexpr double kAsGood = 0.005;
constexpr double kNotEqual = 0.05;  // to be told

double modelled_s(const Pcie& pcie, double bytes, bool read) {
  const auto whole = std::max<std::int64_t>(1, std::llround(bytes));
  return 1e-12 * static_cast<double>(read ? pcie.read_ps(PcieSide::device, whole)
                                          : pcie.posted_write_ps(whole));
}

// log(model / measured) of every size.
std::vector<double> deviations(const Pcie& pcie, const TimesOfSizes& times, bool read) {
  std::vector<double> all;
  for (std::size_t i = 0; i < times.bytes.size(); ++i) {
    all.push_back(std::log(modelled_s(pcie, times.bytes[i], read) / times.seconds[i]));
  }
  return all;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

double mean_size(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += std::abs(v);
  return sum / static_cast<double>(values.size());
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Sets a latency so that the times are neither long nor short in the mean, which grow with it.
void set_latency(Pcie& pcie, double& latency_s, const TimesOfSizes& times, bool read) {
  double low = 0;
  double high = kLongestLatency;
  constexpr double kFine = 1e-11;
  while (high - low > kFine) {
    latency_s = 0.5 * (low + high);
    (mean(deviations(pcie, times, read)) < 0 ? low : high) = latency_s;
  }
  latency_s = low;
}

struct Candidate {
  Pcie pcie;
  double error = std::numeric_limits<double>::infinity();
  int changed = 0;  // of the keys
};

class LinkSearch {
 public:
  LinkSearch(const Pcie& base, const TimesOfSizes& read, const TimesOfSizes& write)
      : base_(base), read_(read), write_(write) {}

  // With the latencies that suit it.
  Candidate measured(Pcie pcie) const {
    if (!write_.empty()) set_latency(pcie, pcie.link_latency_s, write_, false);
    if (!read_.empty()) set_latency(pcie, pcie.root_complex_latency_s, read_, true);
    double error = 0;
    if (!write_.empty()) error = mean_size(deviations(pcie, write_, false));
    if (!read_.empty()) error = std::max(error, mean_size(deviations(pcie, read_, true)));
    const int changed = int{pcie.generation != base_.generation} + int{pcie.lanes != base_.lanes} +
                        int{pcie.max_payload_bytes != base_.max_payload_bytes} +
                        int{pcie.outstanding_reads != base_.outstanding_reads};
    return {pcie, error, changed};
  }

  std::vector<Candidate> all() const {
    std::vector<Candidate> tried;
    for (const PcieGeneration generation : kGenerations) {
      for (const int lanes : kLanes) {
        for (const int payload : kPayloads) {
          Pcie pcie = base_;
          pcie.generation = generation;
          pcie.lanes = lanes;
          pcie.max_payload_bytes = payload;
          tried.push_back(measured(pcie));
          if (read_.empty()) continue;
          for (int reads = 1; reads <= kMostReads; reads *= 2) {
            pcie.outstanding_reads = reads;
            tried.push_back(measured(pcie));
          }
        }
      }
    }
    return tried;
  }

  // Between the powers of two, of the links that are nearest.
  void refine(std::vector<Candidate>& tried) const {
    if (read_.empty()) return;
    constexpr std::size_t kNearest = 12;
    std::ranges::stable_sort(tried, {}, &Candidate::error);
    const std::size_t count = std::min(kNearest, tried.size());
    for (std::size_t i = 0; i < count; ++i) {
      Pcie pcie = tried[i].pcie;
      const int about = pcie.outstanding_reads;
      for (int reads = about / 2 + 1; reads < std::min(2 * about, kMostReads + 1); ++reads) {
        if (reads == about) continue;
        pcie.outstanding_reads = reads;
        tried.push_back(measured(pcie));
      }
    }
  }

 private:
  const Pcie& base_;
  const TimesOfSizes& read_;
  const TimesOfSizes& write_;
};

std::string name_of(const Pcie& pcie) {
  return fmt::format("gen{} x{}", 1 + static_cast<int>(pcie.generation), pcie.lanes);
}

// Other links that are as near: their names once each, but the chosen one's.
void tell_others(const std::vector<Candidate>& tried, const Candidate& chosen, double best,
                 std::vector<std::string>& warnings) {
  std::set<std::string> names;
  for (const Candidate& one : tried) {
    if (one.error <= best + kAsGood) names.insert(name_of(one.pcie));
  }
  names.erase(name_of(chosen.pcie));
  if (names.empty()) return;
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  warnings.push_back(fmt::format("the times alone do not tell {} from {}: state what is known",
                                 name_of(chosen.pcie), all));
}

void tell(const char* direction, double deviation, std::vector<std::string>& warnings) {
  if (deviation <= kNotEqual) return;
  warnings.push_back(
      fmt::format("half of the {}s are more than {:.3g} % off the nearest link that [bus.pcie] has",
                  direction, 100 * deviation));
}

double half_within(const Pcie& pcie, const TimesOfSizes& times, bool read) {
  std::vector<double> sizes = deviations(pcie, times, read);
  for (double& v : sizes) v = std::abs(std::expm1(v));
  return median(std::move(sizes));
}

}  // namespace

TimesOfSizes medians_of_sizes(const std::vector<double>& bytes,
                              const std::vector<double>& seconds) {
  std::map<double, std::vector<double>> by_size;
  for (std::size_t i = 0; i < bytes.size(); ++i) by_size[bytes[i]].push_back(seconds[i]);
  TimesOfSizes times;
  for (auto& [size, all] : by_size) {
    times.bytes.push_back(size);
    times.seconds.push_back(median(std::move(all)));
  }
  return times;
}

NearestPcie nearest_pcie(const Pcie& base, const TimesOfSizes& read, const TimesOfSizes& write) {
  const LinkSearch search(base, read, write);
  std::vector<Candidate> tried = search.all();
  search.refine(tried);
  double best = std::numeric_limits<double>::infinity();
  for (const Candidate& one : tried) best = std::min(best, one.error);
  Candidate chosen;
  chosen.changed = std::numeric_limits<int>::max();
  for (const Candidate& one : tried) {
    if (one.error > best + kAsGood) continue;
    if (std::pair(one.changed, one.error) < std::pair(chosen.changed, chosen.error)) chosen = one;
  }
  NearestPcie nearest;
  nearest.pcie = chosen.pcie;
  tell_others(tried, chosen, best, nearest.warnings);
  if (!read.empty()) {
    nearest.read_deviation = half_within(chosen.pcie, read, true);
    tell("read", *nearest.read_deviation, nearest.warnings);
  }
  if (!write.empty()) {
    nearest.write_deviation = half_within(chosen.pcie, write, false);
    tell("write", *nearest.write_deviation, nearest.warnings);
  }
  return nearest;
}

}  // namespace hvp::fit
