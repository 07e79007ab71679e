// The settings of PCI Express that are nearest to measured times: those of the platform's own link
// are found again, through noise too, and what the times do not tell is said.
#include "models/fit/nearest_pcie.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hvp::fit::nearest_pcie_test {
namespace {

using link::Pcie;
using link::PcieGeneration;
using link::PcieSide;

// From a word to half a megabyte, by steps that are no powers of two.
std::vector<double> sizes() {
  std::vector<double> all;
  for (double size = 64; size < 600e3; size = std::floor(1.6 * size / 4) * 4) all.push_back(size);
  return all;
}

TimesOfSizes times_of(const Pcie& pcie, bool read) {
  TimesOfSizes times;
  for (const double size : sizes()) {
    const auto bytes = static_cast<std::int64_t>(size);
    times.bytes.push_back(size);
    times.seconds.push_back(1e-12 * static_cast<double>(read ? pcie.read_ps(PcieSide::device, bytes)
                                                             : pcie.posted_write_ps(bytes)));
  }
  return times;
}

void expect_same_times(const Pcie& found, const Pcie& truth, double share) {
  for (const double size : sizes()) {
    const auto bytes = static_cast<std::int64_t>(size);
    const auto read = static_cast<double>(truth.read_ps(PcieSide::device, bytes));
    EXPECT_NEAR(static_cast<double>(found.read_ps(PcieSide::device, bytes)), read, share * read)
        << size;
    const auto write = static_cast<double>(truth.posted_write_ps(bytes));
    EXPECT_NEAR(static_cast<double>(found.posted_write_ps(bytes)), write, share * write) << size;
  }
}

TEST(NearestPcie, FindsEveryLinkAgain) {
  for (const PcieGeneration generation :
       {PcieGeneration::gen1, PcieGeneration::gen3, PcieGeneration::gen5}) {
    for (const int lanes : {1, 4, 16}) {
      Pcie truth;
      truth.generation = generation;
      truth.lanes = lanes;
      truth.link_latency_s = 210e-9;
      truth.root_complex_latency_s = 480e-9;
      const NearestPcie found = nearest_pcie({}, times_of(truth, true), times_of(truth, false));
      expect_same_times(found.pcie, truth, 0.01);
      EXPECT_LT(*found.read_deviation, 0.005);
      EXPECT_LT(*found.write_deviation, 0.005);
    }
  }
}

// A slow root complex and few tags: the reads in flight bound the rate, not the wire.
TEST(NearestPcie, FindsTheReadsInFlight) {
  for (const int reads : {3, 6, 20}) {
    Pcie truth;
    truth.outstanding_reads = reads;
    truth.root_complex_latency_s = 5e-6;
    const NearestPcie found = nearest_pcie({}, times_of(truth, true), times_of(truth, false));
    EXPECT_EQ(found.pcie.outstanding_reads, reads);
    EXPECT_EQ(found.pcie.generation, truth.generation);
    EXPECT_EQ(found.pcie.lanes, truth.lanes);
    EXPECT_NEAR(found.pcie.root_complex_latency_s, 5e-6, 0.05e-6);
    EXPECT_NEAR(found.pcie.link_latency_s, truth.link_latency_s, 2e-9);
    expect_same_times(found.pcie, truth, 0.005);
  }
}

// One reading each, with noise of 3 %, and some that an interrupt made long.
TEST(NearestPcie, BearsNoiseAndInterrupts) {
  Pcie truth;
  truth.generation = PcieGeneration::gen2;
  truth.lanes = 8;
  truth.root_complex_latency_s = 700e-9;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<double> bytes;
  std::vector<double> seconds;
  const TimesOfSizes exact = times_of(truth, true);
  for (std::size_t i = 0; i < exact.bytes.size(); ++i) {
    for (int n = 0; n < 9; ++n) {
      bytes.push_back(exact.bytes[i]);
      seconds.push_back(exact.seconds[i] * (1 + 0.03 * normal(random)) + (n == 0 ? 50e-6 : 0));
    }
  }
  const TimesOfSizes measured = medians_of_sizes(bytes, seconds);
  ASSERT_EQ(measured.bytes, exact.bytes);
  const NearestPcie found = nearest_pcie({}, measured, {});
  EXPECT_FALSE(found.write_deviation);
  EXPECT_LT(*found.read_deviation, 0.03);
  for (const double size : {4096.0, 400e3}) {
    const auto whole = static_cast<std::int64_t>(size);
    const auto read = static_cast<double>(truth.read_ps(PcieSide::device, whole));
    EXPECT_NEAR(static_cast<double>(found.pcie.read_ps(PcieSide::device, whole)), read,
                0.05 * read);
  }
}

// Without writes the link keeps its latency, and the keys that need not change do not.
TEST(NearestPcie, KeepsWhatTheTimesDoNotTell) {
  Pcie base;
  base.generation = PcieGeneration::gen2;
  base.lanes = 8;
  base.link_latency_s = 99e-9;
  const NearestPcie found = nearest_pcie(base, times_of(base, true), {});
  EXPECT_EQ(found.pcie.generation, base.generation);
  EXPECT_EQ(found.pcie.lanes, base.lanes);
  EXPECT_EQ(found.pcie.outstanding_reads, base.outstanding_reads);
  EXPECT_EQ(found.pcie.max_payload_bytes, base.max_payload_bytes);
  EXPECT_EQ(found.pcie.link_latency_s, base.link_latency_s);
  EXPECT_NEAR(found.pcie.root_complex_latency_s, base.root_complex_latency_s, 2e-9);
}

// Two lanes of one generation are about one of the next: said by name.
TEST(NearestPcie, NamesTheLinksThatAreAsNear) {
  Pcie truth;
  truth.generation = PcieGeneration::gen4;
  truth.lanes = 4;
  const NearestPcie found = nearest_pcie(truth, times_of(truth, true), times_of(truth, false));
  EXPECT_EQ(found.pcie.lanes, 4);
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_THAT(found.warnings.front(), ::testing::HasSubstr("gen4 x4 from "));
  EXPECT_THAT(found.warnings.front(), ::testing::HasSubstr("gen3 x8"));
}

// No PCI Express is as slow as a serial line.
TEST(NearestPcie, SaysWhereNoLinkIsNear) {
  TimesOfSizes slow;
  slow.bytes = {100, 1000, 10000, 100000};
  slow.seconds = {1e-3, 10e-3, 100e-3, 1};
  const NearestPcie found = nearest_pcie({}, slow, {});
  EXPECT_GT(*found.read_deviation, 0.05);
  EXPECT_THAT(found.warnings.back(), ::testing::HasSubstr("off the nearest link"));
}

}  // namespace
}  // namespace hvp::fit::nearest_pcie_test
