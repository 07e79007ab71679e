// The protocol without a socket: what each command answers, and what it refuses.
#include "app/serve/session.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>

#include "tests/serve/session_client.h"

namespace hvp::serve::session_test {
namespace {

using test::bytes_of;
using test::SessionClient;
using ::testing::ElementsAre;

nlohmann::json capabilities_of(const test::Answer& answer) {
  const std::string text(answer.body.begin() + sizeof(Version), answer.body.end() - 1);
  EXPECT_EQ(answer.body.back(), 0);
  return nlohmann::json::parse(text).at("capabilities");
}

// A client refuses a higher minor than its own in the reply.
TEST(Session, AgreesOnTheLowerMinor) {
  for (const std::uint16_t minor : std::initializer_list<std::uint16_t>{0, 1, 7}) {
    SessionClient client(false);
    const test::Answer answer = client.version(0, minor, "");
    EXPECT_EQ(answer.error, 0);
    EXPECT_EQ(answer.as<Version>().major, 0);
    EXPECT_EQ(answer.as<Version>().minor, std::min<std::uint16_t>(minor, 1));
    const nlohmann::json capabilities = capabilities_of(answer);
    EXPECT_EQ(capabilities.at("max_data_xfer_size"), 1U << 20U);
    EXPECT_EQ(capabilities.at("max_msg_fds"), 8);
    EXPECT_FALSE(capabilities.contains("write_multiple"));
    EXPECT_TRUE(client.session->open());
  }
}

TEST(Session, RefusesAnotherMajorAndWhatIsNoJson) {
  SessionClient client(false);
  EXPECT_EQ(client.version(1, 0, "").error, ENOTSUP);
  EXPECT_EQ(client.version(0, 1, "{\"capabilities\":").error, EINVAL);
  EXPECT_EQ(client.version(0, 1, "[]").error, EINVAL);
  EXPECT_EQ(client.version(0, 1, R"({"capabilities":3})").error, EINVAL);
  EXPECT_EQ(client.send(Request::version, {0, 0}).error, EINVAL);
  EXPECT_FALSE(client.session->open());
  EXPECT_EQ(client.version(0, 1, R"({"capabilities":{"max_msg_fds":"many"}})").error, 0);
  EXPECT_EQ(client.version(0, 1, "").error, EINVAL);
}

TEST(Session, NothingComesBeforeTheVersion) {
  SessionClient client(false);
  EXPECT_THROW(client.send(Request::device_get_info, bytes_of(DeviceInfo{16, 0, 0, 0})), Broken);
}

TEST(Session, DescribesTheDevice) {
  SessionClient client;
  const auto info =
      client.send(Request::device_get_info, bytes_of(DeviceInfo{16, 0, 0, 0})).as<DeviceInfo>();
  EXPECT_EQ(info.argsz, 16U);
  EXPECT_EQ(info.flags, 3U);  // resets, PCI
  EXPECT_EQ(info.regions, 9U);
  EXPECT_EQ(info.interrupts, 5U);
  EXPECT_EQ(client.send(Request::device_get_info, bytes_of(DeviceInfo{8, 0, 0, 0})).error, EINVAL);
  for (std::uint32_t index = 0; index < 9; ++index) {
    const auto region =
        client.send(Request::device_get_region_info, bytes_of(RegionInfo{32, 0, index, 0, 0, 0}))
            .as<RegionInfo>();
    EXPECT_EQ(region.size, index == 0 ? 2U << 20U : index == 7 ? 256U : 0U);
    EXPECT_EQ(region.flags, region.size > 0 ? 3U : 0U);
  }
  EXPECT_EQ(
      client.send(Request::device_get_region_info, bytes_of(RegionInfo{32, 0, 9, 0, 0, 0})).error,
      EINVAL);
  for (const std::uint32_t index : {0U, 1U, 2U}) {
    const auto interrupt =
        client.send(Request::device_get_irq_info, bytes_of(InterruptInfo{16, 0, index, 0}))
            .as<InterruptInfo>();
    EXPECT_EQ(interrupt.count, index < 2 ? 1U : 0U);
    EXPECT_EQ(interrupt.flags, index == 0 ? 7U : index == 1 ? 9U : 0U);
  }
}

// In BAR 2, by words, and with interrupts of an index of its own. A file for the vector unmasks it.
TEST(Session, MessagesMayHaveATable) {
  SessionClient client(true, 4096);
  const auto region =
      client.send(Request::device_get_region_info, bytes_of(RegionInfo{32, 0, 2, 0, 0, 0}))
          .as<RegionInfo>();
  EXPECT_EQ(region.size, 4096U);
  EXPECT_EQ(region.flags, 3U);
  for (const std::uint32_t index : {1U, 2U}) {
    const auto interrupt =
        client.send(Request::device_get_irq_info, bytes_of(InterruptInfo{16, 0, index, 0}))
            .as<InterruptInfo>();
    EXPECT_EQ(interrupt.count, index == 2 ? 1U : 0U);
    EXPECT_EQ(interrupt.flags, index == 2 ? 9U : 0U);
  }
  const Bytes write = bytes_of(RegionAccess{8, 2, 8}, std::uint64_t{0x1122'3344});
  EXPECT_EQ(client.send(Request::region_write, write).error, 0);
  EXPECT_EQ(client.send(Request::region_read, bytes_of(RegionAccess{8, 2, 4})).error, 0);
  EXPECT_EQ(client.function.table[8], 0x44);
  EXPECT_THAT(client.function.accesses, ElementsAre(4U, 4U, 4U));
  EXPECT_EQ(client.send(Request::region_read, bytes_of(RegionAccess{4096, 2, 4})).error, EINVAL);

  constexpr std::uint32_t kGive = kDataEventfd | kActionTrigger;
  const FileDescriptor event = test::eventfd();
  EXPECT_EQ(client.interrupts(kGive, 1, 0, 1, test::copy_of(event)).error, EINVAL);
  EXPECT_TRUE(client.function.masks.empty());
  EXPECT_EQ(client.interrupts(kGive, 2, 0, 1, test::copy_of(event)).error, 0);
  client.session->interrupts().message();
  EXPECT_EQ(test::signals(event), 1U);
  EXPECT_EQ(client.interrupts(kDataNone | kActionTrigger, 2, 0, 1).error, 0);
  EXPECT_EQ(test::signals(event), 1U);
  EXPECT_THAT(client.function.masks, ElementsAre(false));
  EXPECT_EQ(client.interrupts(kDataNone | kActionTrigger, 2, 0, 0).error, 0);
  EXPECT_THAT(client.function.masks, ElementsAre(false, true));
  client.session->interrupts().message();
  EXPECT_EQ(test::signals(event), 0U);
}

TEST(Session, RegionsAreReadAndWritten) {
  SessionClient client;
  Bytes write = bytes_of(RegionAccess{0x100, 0, 8}, std::uint64_t{0x1122'3344'5566'7788});
  EXPECT_EQ(client.send(Request::region_write, write).as<RegionAccess>().count, 8U);
  const test::Answer answer =
      client.send(Request::region_read, bytes_of(RegionAccess{0x104, 0, 2}));
  EXPECT_EQ(answer.body.size(), sizeof(RegionAccess) + 2);
  Fields fields(answer.body);
  EXPECT_EQ(fields.take<RegionAccess>().offset, 0x104U);
  EXPECT_EQ(fields.take<std::uint16_t>(), 0x3344U);
  EXPECT_THAT(client.function.accesses, ElementsAre(8U, 2U));
}

// QEMU reads all of it at once.
TEST(Session, ABlockOfConfigurationSpaceIsAccessesOfABus) {
  SessionClient client;
  client.send(Request::region_read, bytes_of(RegionAccess{1, 7, 12}));
  EXPECT_THAT(client.function.accesses, ElementsAre(1U, 2U, 4U, 4U, 1U));
  client.function.accesses.clear();
  EXPECT_EQ(client.send(Request::region_read, bytes_of(RegionAccess{0, 7, 256})).error, 0);
  EXPECT_EQ(client.function.accesses.size(), 64U);
}

TEST(Session, RefusesWhatIsBeyondARegion) {
  SessionClient client;
  const std::uint64_t bar = client.function.bar.size();
  for (const RegionAccess& access :
       {RegionAccess{bar, 0, 4}, RegionAccess{bar - 2, 0, 4}, RegionAccess{0, 0, 0},
        RegionAccess{~std::uint64_t{3}, 0, 4}, RegionAccess{0, 0, ~0U}, RegionAccess{0, 1, 4},
        RegionAccess{0, 7, 257}, RegionAccess{0, 1000, 4},
        RegionAccess{0, 0, static_cast<std::uint32_t>(kLargestTransfer) + 1}}) {
    EXPECT_EQ(client.send(Request::region_read, bytes_of(access)).error, EINVAL) << access.offset;
    EXPECT_EQ(client.send(Request::region_write, bytes_of(access)).error, EINVAL) << access.offset;
  }
  // Less data than it says.
  EXPECT_EQ(client.send(Request::region_write, bytes_of(RegionAccess{0, 0, 8}, 1U)).error, EINVAL);
  EXPECT_EQ(client.send(Request::region_read, {1, 2, 3}).error, EINVAL);
  EXPECT_TRUE(client.function.accesses.empty());
}

TEST(Session, ABoardThatIsDeadIsAnInputOutputError) {
  SessionClient client;
  client.function.answers = false;
  EXPECT_EQ(client.send(Request::region_read, bytes_of(RegionAccess{0, 0, 4})).error, EIO);
  EXPECT_EQ(client.send(Request::region_write, bytes_of(RegionAccess{0, 0, 4}, 1U)).error, EIO);
}

TEST(Session, SeveralWritesInOneMessage) {
  SessionClient client;
  const Bytes two = bytes_of(std::uint64_t{2}, RegionAccess{0, 0, 4}, std::uint64_t{0xaabb'ccdd},
                             RegionAccess{8, 0, 2}, std::uint64_t{0x1234});
  EXPECT_EQ(client.send(Request::region_write_multi, two).as<std::uint64_t>(), 2U);
  EXPECT_EQ(client.function.bar[0], 0xdd);
  EXPECT_EQ(client.function.bar[9], 0x12);
  EXPECT_EQ(client.function.bar[10], 0);
  const Bytes long_one =
      bytes_of(std::uint64_t{1}, RegionAccess{0, 0, 9}, std::uint64_t{0}, std::uint64_t{0});
  EXPECT_EQ(client.send(Request::region_write_multi, long_one).error, EINVAL);
  EXPECT_EQ(client.send(Request::region_write_multi, bytes_of(~std::uint64_t{0})).error, EINVAL);
  SessionClient older(false);
  older.version(0, 0, R"({"capabilities":{"write_multiple":true}})");
  EXPECT_EQ(older.send(Request::region_write_multi, two).error, ENOTSUP);
}

TEST(Session, WhatItHasNotIsRefused) {
  SessionClient client;
  for (const std::uint16_t command :
       std::initializer_list<std::uint16_t>{0, 6, 11, 12, 14, 16, 17, 18, 65535}) {
    EXPECT_EQ(client.send(static_cast<Request>(command), {}).error, ENOTSUP) << command;
  }
}

TEST(Session, NoReplyIsNone) {
  SessionClient client;
  for (const std::uint32_t offset : {0U, 0xffff'fff0U}) {  // one that is refused too
    const Bytes body = bytes_of(RegionAccess{offset, 0, 4}, 5U);
    const Header header{.id = 1,
                        .command = static_cast<std::uint16_t>(Request::region_write),
                        .size = static_cast<std::uint32_t>(sizeof header + body.size()),
                        .flags = kNoReply};
    EXPECT_TRUE(client.session->take({header, body, {}}).empty());
  }
  EXPECT_EQ(client.function.bar[0], 5);
}

TEST(Session, TheEndLeavesABoardAsAfterPowerOn) {
  SessionClient client;
  EXPECT_EQ(client.send(Request::device_reset, {}).error, 0);
  EXPECT_EQ(client.function.resets, 1);
  client.map(0x1000, 4096, test::memfd(4096));
  client.session.reset();
  EXPECT_EQ(client.function.resets, 2);
  EXPECT_TRUE(client.function.maps.empty());
}

// Of each path: kept, refused, of no use to the command, with a message that breaks the session.
TEST(Session, EveryFileIsClosed) {
  const std::ptrdiff_t before = test::open_files();
  {
    SessionClient client;
    const std::ptrdiff_t open = test::open_files();
    const auto event = [&client](FileDescriptor file) {
      return client.interrupts(kDataEventfd | kActionTrigger, 1, 0, 1, std::move(file)).error;
    };
    EXPECT_EQ(client.map(0x1000, 4096, test::memfd(4096)).error, 0);
    EXPECT_EQ(test::open_files(), open + 1);
    EXPECT_EQ(client.map(0x1000, 4096, test::memfd(4096)).error, EEXIST);
    EXPECT_EQ(client.map(test::FakeFunction::kWindow, 4096, test::memfd(4096)).error, EINVAL);
    EXPECT_EQ(
        client.send(Request::region_read, bytes_of(RegionAccess{0, 0, 4}), test::eventfd()).error,
        0);
    EXPECT_EQ(test::open_files(), open + 1);
    EXPECT_EQ(client.unmap(0x1000, 4096).error, 0);
    EXPECT_EQ(test::open_files(), open);
    EXPECT_EQ(event(test::eventfd()), 0);
    EXPECT_EQ(event(test::eventfd()), 0);
    EXPECT_EQ(test::open_files(), open + 1);
    EXPECT_EQ(event(test::memfd(8)), EINVAL);
    EXPECT_EQ(client.interrupts(kDataNone | kActionTrigger, 1, 0, 0).error, 0);
    EXPECT_EQ(test::open_files(), open);
    std::vector<FileDescriptor> many;
    for (int i = 0; i < 9; ++i) many.push_back(test::eventfd());
    EXPECT_EQ(client.send(Request::device_reset, {}, std::move(many)).error, EINVAL);
    EXPECT_EQ(test::open_files(), open);
    event(test::eventfd());
  }
  SessionClient broken(false);
  EXPECT_THROW(broken.map(0x1000, 4096, test::memfd(4096)), Broken);
  EXPECT_EQ(test::open_files(), before);
}

TEST(Message, AHeaderSaysHowMuchFollows) {
  const auto parse = [](const Header& header) {
    const Bytes bytes = bytes_of(header);
    return parse_header(std::span<const std::uint8_t, sizeof(Header)>(bytes));
  };
  EXPECT_EQ(parse({1, 2, 16, 0, 0}).size, 16U);
  EXPECT_EQ(parse({1, 2, static_cast<std::uint32_t>(kLargestMessage), kNoReply, 0}).command, 2);
  EXPECT_THROW(parse({1, 2, 15, 0, 0}), Broken);
  EXPECT_THROW(parse({1, 2, 0, 0, 0}), Broken);
  EXPECT_THROW(parse({1, 2, static_cast<std::uint32_t>(kLargestMessage) + 1, 0, 0}), Broken);
  EXPECT_THROW(parse({1, 2, 0xffff'ffff, 0, 0}), Broken);
  EXPECT_THROW(parse({1, 2, 16, kReplyType, 0}), Broken);
}

}  // namespace
}  // namespace hvp::serve::session_test
