#include "models/link/read_latencies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "models/link/pci.h"
#include "models/link/pcie.h"
#include "models/link/pcie_link.h"

namespace hvp::link::read_latencies_test {
namespace {

constexpr std::int64_t kNs = 1'000;

class Times : public CompleterTimes {
 public:
  explicit Times(std::vector<std::int64_t> ps) : ps_(std::move(ps)) {}
  std::int64_t ps(std::int64_t request) const override {
    return ps_.at(static_cast<std::size_t>(request));
  }

 private:
  std::vector<std::int64_t> ps_;
};

Times same(const Pcie& pcie, std::int64_t bytes, std::int64_t ps) {
  return Times(std::vector<std::int64_t>(static_cast<std::size_t>(pcie.requests(bytes)), ps));
}

// Reads of 64 bytes over Gen3 x8, as SIGCOMM'18 measured them: in ns, ascending.
std::vector<double> published_like(RootComplexLatencies::PublishedHost host) {
  RootComplexLatencies latencies;
  latencies.host = host;
  latencies.check();
  const random::Source source(latencies.drawn(), 1, "test");
  Pcie pcie;
  pcie.generation = PcieGeneration::gen3;
  pcie.lanes = 8;
  std::vector<double> reads;
  for (int n = 0; n < 100'000; ++n) {
    const std::int64_t ps = std::llround(1e12 * source.time_s(n));
    reads.push_back(1e-3 * static_cast<double>(pcie.read_ps(PcieSide::device, 64, Times({ps}))));
  }
  std::sort(reads.begin(), reads.end());
  return reads;
}

// The share of 100 000 draws below the median is 0.5 ± 0.0063, four standard deviations: 0.2 ns of
// an E5's times and 6 ns of an E3's.
TEST(PublishedReads, HaveTheirMediansAndTails) {
  const std::vector<double> e5 = published_like(RootComplexLatencies::xeon_e5);
  EXPECT_NEAR(e5[50'000], 547, 0.3);
  EXPECT_LT(e5[99'900], 600) << "narrow";
  const std::vector<double> e3 = published_like(RootComplexLatencies::xeon_e3);
  EXPECT_NEAR(e3[50'000], 1213, 16);
  // 100 ± 40 reads are beyond the 99.9th percentile, where the power law is t ~ share^-0.37.
  EXPECT_NEAR(e3[99'900], 12e3, 2e3);
  EXPECT_LE(e3.back(), 12e3 + 1) << "nothing is known beyond, and nothing is drawn";
  EXPECT_GE(e3.front(), 517);
}

TEST(PublishedReads, MedianOfTheE5IsTheConstantsRead) {
  const double beside = published_reads_beside_root_complex_s();
  EXPECT_NEAR(547e-9 - beside, Pcie{}.root_complex_latency_s, 0.5e-9);
}

TEST(LatencyTables, DefaultsHaveTheMeanOfTheirConstants) {
  const PciReadLatencies pci;
  EXPECT_DOUBLE_EQ(pci.minimum_s + pci.mean_s, Pci{}.read_latency_s);
  const RootComplexLatencies root;
  EXPECT_DOUBLE_EQ(root.minimum_s + root.mean_s, Pcie{}.root_complex_latency_s);
  pci.check();
}

TEST(RequestTimes, EqualOnesAreTheFormulaToThePicosecond) {
  for (const auto generation : {PcieGeneration::gen1, PcieGeneration::gen3, PcieGeneration::gen6}) {
    for (const int tags : {1, 3, 32}) {
      for (const std::int64_t bytes : {4, 64, 512, 3'000, 24'000}) {
        Pcie pcie;
        pcie.generation = generation;
        pcie.outstanding_reads = tags;
        const std::int64_t constant = pcie.completer_ps(PcieSide::device);
        const std::int64_t formula = pcie.read_ps(PcieSide::device, bytes);
        EXPECT_EQ(pcie.read_ps(PcieSide::device, bytes, same(pcie, bytes, constant)), formula);
        // With tags enough, what each takes longer the read takes longer once.
        const std::int64_t longer =
            pcie.read_ps(PcieSide::device, bytes, same(pcie, bytes, constant + 700 * kNs)) -
            formula;
        const std::int64_t rounds = (pcie.requests(bytes) + tags - 1) / tags;
        if (rounds == 1 || tags == 1) {
          EXPECT_EQ(longer, rounds * 700 * kNs) << bytes;
        } else {
          EXPECT_GE(longer, 700 * kNs) << bytes;
          EXPECT_LE(longer, rounds * 700 * kNs) << bytes;
        }
      }
    }
  }
}

// Completions keep the order of the requests: a slow one holds those behind it up, and a slow last
// one is late by what the others' data have not covered.
TEST(RequestTimes, ASlowRequestHoldsUpThoseBehindIt) {
  const Pcie pcie;
  const std::int64_t bytes = 3 * pcie.max_read_request_bytes;
  const std::int64_t c = pcie.completer_ps(PcieSide::device);
  const std::int64_t formula = pcie.read_ps(PcieSide::device, bytes);
  const std::int64_t slow = 5'000 * kNs;
  const auto read = [&](std::vector<std::int64_t> times) {
    return pcie.read_ps(PcieSide::device, bytes, Times(std::move(times)));
  };
  EXPECT_EQ(read({c + slow, c, c}), formula + slow);
  const std::int64_t request = pcie.tlp_ps(24);
  const std::int64_t completion = pcie.tlp_ps(512 + 2 * 20);
  EXPECT_EQ(read({c, c + slow, c}), formula + slow + request - completion);
  EXPECT_EQ(read({c, c, c + slow}), formula + slow + 2 * (request - completion));
  EXPECT_EQ(read({c + slow, c + slow, c + slow}), formula + slow) << "they overlap";
}

// The packet engine asks for the same times, whatever is forecast in between.
TEST(RequestTimes, ThePacketEngineTakesWhatTheFormulaTakes) {
  RootComplexLatencies latencies;
  latencies.host = RootComplexLatencies::xeon_e3;
  const random::Source source(latencies.drawn(), 1, "test");
  constexpr std::array<PcieSide, 2> kSides = {PcieSide::root, PcieSide::device};
  for (const std::int64_t bytes : {64, 512, 3'000, 24'000}) {
    for (const int tags : {2, 32}) {
      Pcie pcie;
      pcie.outstanding_reads = tags;
      PcieLink link(pcie, kSides);
      double engine = 0;
      double formula = 0;
      std::int64_t now = 0;
      for (int read = 0; read < 200; ++read) {
        std::vector<std::int64_t> ps;
        for (std::uint32_t k = 0; k < pcie.requests(bytes); ++k) {
          ps.push_back(std::llround(1e12 * source.time_s(read, k)));
        }
        const Times times(ps);
        link.request(1, Direction::read, bytes, now, &times);
        const std::int64_t end = link.forecast(1);
        link.advance(now + (end - now) / 2);
        EXPECT_EQ(link.forecast(1), end);
        link.advance(end);
        EXPECT_TRUE(link.done(1));
        engine += static_cast<double>(end - now);
        formula += static_cast<double>(pcie.read_ps(PcieSide::device, bytes, times));
        now = end + 1'000 * kNs;
      }
      EXPECT_NEAR(engine / formula, 1, 0.01) << bytes << " bytes, " << tags << " tags";
      // Without times the next read is the constant's again.
      link.request(1, Direction::read, 64, now);
      const std::int64_t alone = link.forecast(1) - now;
      EXPECT_NEAR(static_cast<double>(alone),
                  static_cast<double>(pcie.read_ps(PcieSide::device, 64)), 10e3);
    }
  }
}

}  // namespace
}  // namespace hvp::link::read_latencies_test
