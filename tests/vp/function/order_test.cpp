// What may not overtake what between a host and the board (PCIe 5.0 §2.4.1 table 2-40; PCI 3.0
// appendix E): every pair of a side's transactions, on each bus.
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/function/outside_host_rig.h"

namespace hvp::vp::outside_host_test {
namespace {

enum class Bus { pci, pci_posted, pcie, pcie_exact };
constexpr std::array kBuses = {Bus::pci, Bus::pci_posted, Bus::pcie, Bus::pcie_exact};
constexpr std::array<const char*, 4> kBusNames = {"pci", "pci_posted", "pcie", "pcie_exact"};

void put_on(Bus bus, PlatformSettings& settings) {
  if (bus == Bus::pci_posted) settings.bus.posted_writes.emplace();
  if (bus == Bus::pcie || bus == Bus::pcie_exact) settings.bus.pcie.emplace();
  if (bus == Bus::pcie_exact) settings.fidelity.bus = Timing::approximately_timed;
}

// What a host sends. Each sets something, or finds out what was set.
enum class Sent { write, configuration_write, read, configuration_read };
constexpr std::array<const char*, 4> kSentNames = {"write", "configuration_write", "read",
                                                   "configuration_read"};

class FromTheHost : public testing::TestWithParam<std::tuple<Bus, Sent, Sent>> {};

// The second is made while a write of the host before it may be under way, and finds what the first
// has done.
TEST_P(FromTheHost, TheSecondFindsTheFirst) {
  const Bus bus = std::get<0>(GetParam());
  const Sent first = std::get<1>(GetParam());
  const Sent second = std::get<2>(GetParam());
  Host host([bus](PlatformSettings& settings) { put_on(bus, settings); });
  const RegisterBank& bank = host.side->board()->accelerator().bank();
  host.command(kMemorySpace);
  host.write(Register::method, 1);
  ASSERT_EQ(host.read(Register::method), 1U);  // which brings it there
  switch (first) {
    case Sent::write:
      host.write(Register::method, 3);
      break;
    case Sent::configuration_write:
      host.command(0);
      break;
    case Sent::read:
      EXPECT_EQ(host.read(Register::method), 1U);
      EXPECT_EQ(bank.get(Register::method), 1U);
      return;
    case Sent::configuration_read:
      EXPECT_EQ(host.read_config(kCommandRegister) & 0xffffU, std::uint32_t{kMemorySpace});
      EXPECT_EQ(bank.get(Register::method), 1U);
      return;
  }
  const bool wrote = first == Sent::write;
  switch (second) {
    case Sent::write:
      host.write(Register::method, 2);
      host.command(kMemorySpace);
      EXPECT_EQ(host.read(Register::method), wrote ? 2U : 1U);
      break;
    case Sent::configuration_write:
      // A reset forgets what the first has set, and nothing sets it afterwards.
      host.write_config(ConfigSpace::kFeaturesAt + 4, 1, 1);
      host.command(kMemorySpace);
      EXPECT_EQ(host.read(Register::method), 0U);
      break;
    case Sent::read:
      EXPECT_EQ(host.read(Register::method), wrote ? 3U : 0xffff'ffffU);
      break;
    case Sent::configuration_read:
      EXPECT_EQ(host.read_config(kCommandRegister) & 0xffffU,
                wrote ? std::uint32_t{kMemorySpace} : 0U);
      EXPECT_EQ(bank.get(Register::method), wrote ? 3U : 1U);
      break;
  }
}

std::string name_of_pair(const testing::TestParamInfo<std::tuple<Bus, Sent, Sent>>& test) {
  const auto [bus, first, second] = test.param;
  return std::string(kBusNames[static_cast<std::size_t>(bus)]) + "_" +
         kSentNames[static_cast<std::size_t>(first)] + "_then_" +
         kSentNames[static_cast<std::size_t>(second)];
}

INSTANTIATE_TEST_SUITE_P(All, FromTheHost,
                         testing::Combine(testing::ValuesIn(kBuses),
                                          testing::Values(Sent::write, Sent::configuration_write,
                                                          Sent::read, Sent::configuration_read),
                                          testing::Values(Sent::write, Sent::configuration_write,
                                                          Sent::read, Sent::configuration_read)),
                         name_of_pair);

// What tells the host of a job's end, behind U and the record in its memory.
enum class News { message, line, read, configuration_read };
constexpr std::array<const char*, 4> kNewsNames = {"message", "line", "read", "configuration_read"};

class FromTheBoard : public testing::TestWithParam<std::tuple<Bus, News>> {};

TEST_P(FromTheBoard, TheHostsMemoryHasWhatTheBoardWroteBefore) {
  const Bus bus = std::get<0>(GetParam());
  const News news = std::get<1>(GetParam());
  Loaded host([bus, news](PlatformSettings& settings) {
    with_dma(settings);
    put_on(bus, settings);
    if (news == News::message) settings.transfer.notification = link::Notification::msi;
  });
  GuestMemory memory(host);
  ASSERT_EQ(hvp_use_dma(&host.device, &memory.dma), HVP_OK);
  if (news == News::message) {
    host.write_config(ConfigSpace::kMessageAt + 4, 0xfee0'0000, 4);
    host.write_config(ConfigSpace::kMessageAt + 2, 1, 2);
  }
  host.messages.clear();
  host.lines.clear();
  ASSERT_EQ(hvp_write_rhs(&host.device, host.b.data(), host.b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&host.device), HVP_OK);
  const RegisterBank& bank = host.side->board()->accelerator().bank();
  const auto heard = [&] {
    switch (news) {
      case News::message:
        return !host.messages.empty();
      case News::line:
        return host.host->line_is_up();
      case News::read:
        return (host.read(Register::status) & field::kStatusDone.mask()) != 0;
      case News::configuration_read: {
        const bool done = bank.get(field::kStatusDone) != 0;
        host.read_config(kCommandRegister);
        return done;
      }
    }
    return true;
  };
  while (!heard()) {
    ASSERT_LT(now_ps(), 100'000 * test::kUs);
    host.host->run_until(now_ps() + 10'000);
  }
  const bool may_overtake = news == News::line && (bus == Bus::pci || bus == Bus::pci_posted);
  if (!may_overtake) {
    EXPECT_EQ(memory.dma.record[7], 1U);
    const std::vector<std::uint32_t> seen = memory.high;
    ASSERT_EQ(hvp_wait(&host.device, 100'000'000), HVP_OK);
    ASSERT_EQ(hvp_read_solution(&host.device, host.u.data(), host.u.size()), HVP_OK);
    EXPECT_EQ(host.u, host.expected());
    EXPECT_EQ(seen, memory.high);
  }
}

std::string name_of_news(const testing::TestParamInfo<std::tuple<Bus, News>>& test) {
  const auto [bus, news] = test.param;
  return std::string(kBusNames[static_cast<std::size_t>(bus)]) + "_" +
         kNewsNames[static_cast<std::size_t>(news)];
}

INSTANTIATE_TEST_SUITE_P(All, FromTheBoard,
                         testing::Combine(testing::ValuesIn(kBuses),
                                          testing::Values(News::message, News::line, News::read,
                                                          News::configuration_read)),
                         name_of_news);

}  // namespace
}  // namespace hvp::vp::outside_host_test
