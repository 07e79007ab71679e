#include "app/serve/interrupts.h"

#include <fcntl.h>

#include "tests/serve/session_client.h"

namespace hvp::serve::interrupts_test {
namespace {

using test::SessionClient;
using test::signals;

constexpr std::uint32_t kGive = kDataEventfd | kActionTrigger;
constexpr std::uint32_t kUnmaskIt = kDataNone | kActionUnmask;

TEST(Interrupts, AMessageIsAnEdge) {
  SessionClient client;
  client.session->interrupts().message();  // nobody has asked for it
  const FileDescriptor event = test::eventfd();
  ASSERT_EQ(client.interrupts(kGive, 1, 0, 1, test::copy_of(event)).error, 0);
  EXPECT_EQ(signals(event), 0U);
  client.session->interrupts().message();
  client.session->interrupts().message();
  EXPECT_EQ(signals(event), 2U);
  ASSERT_EQ(client.interrupts(kGive, 1, 0, 1).error, 0);  // without a file: taken away
  client.session->interrupts().message();
  EXPECT_EQ(signals(event), 0U);
}

// Of a function on PCI Express alone.
TEST(Interrupts, AnErrorIsAnEdge) {
  for (const bool on_a_link : {false, true}) {
    SessionClient client;
    client.function.errors = on_a_link;
    client.session.emplace(client.function);
    client.version(0, 1, "");
    const auto info =
        client.send(Request::device_get_irq_info, test::bytes_of(InterruptInfo{16, 0, 3, 0}))
            .as<InterruptInfo>();
    EXPECT_EQ(info.count, on_a_link ? 1U : 0U);
    EXPECT_EQ(info.flags, on_a_link ? 9U : 0U);
    const FileDescriptor event = test::eventfd();
    EXPECT_EQ(client.interrupts(kGive, 3, 0, 1, test::copy_of(event)).error,
              on_a_link ? 0 : EINVAL);
    client.session->interrupts().error();
    client.session->interrupts().message();
    EXPECT_EQ(signals(event), on_a_link ? 1U : 0U);
  }
}

TEST(Interrupts, ALineIsSignalledOnceUntilItIsUnmasked) {
  SessionClient client;
  const FileDescriptor event = test::eventfd();
  ASSERT_EQ(client.interrupts(kGive, 0, 0, 1, test::copy_of(event)).error, 0);
  client.function.line = true;
  client.session->interrupts().line(true);
  EXPECT_EQ(signals(event), 1U);
  client.session->interrupts().line(true);
  EXPECT_EQ(signals(event), 0U);
  // Still up: signalled again.
  ASSERT_EQ(client.interrupts(kUnmaskIt, 0, 0, 1).error, 0);
  EXPECT_EQ(signals(event), 1U);
  client.function.line = false;
  client.session->interrupts().line(false);
  ASSERT_EQ(client.interrupts(kUnmaskIt, 0, 0, 1).error, 0);
  EXPECT_EQ(signals(event), 0U);
  client.function.line = true;
  client.session->interrupts().line(true);
  EXPECT_EQ(signals(event), 1U);
}

TEST(Interrupts, AMaskedLineWaits) {
  SessionClient client;
  const FileDescriptor event = test::eventfd();
  client.function.line = true;
  client.session->interrupts().line(true);
  // Up before anybody asked.
  ASSERT_EQ(client.interrupts(kGive, 0, 0, 1, test::copy_of(event)).error, 0);
  EXPECT_EQ(signals(event), 1U);
  ASSERT_EQ(client.interrupts(kUnmaskIt, 0, 0, 1).error, 0);
  signals(event);
  client.session->interrupts().line(false);
  ASSERT_EQ(client.interrupts(kUnmaskIt, 0, 0, 1).error, 0);
  client.function.line = false;
  ASSERT_EQ(client.interrupts(kUnmaskIt, 0, 0, 1).error, 0);
  signals(event);
  ASSERT_EQ(client.interrupts(kDataNone | kActionMask, 0, 0, 1).error, 0);
  client.session->interrupts().line(true);
  EXPECT_EQ(signals(event), 0U);
  // A boolean that is false does nothing.
  client.function.line = true;
  ASSERT_EQ(client.interrupts(kDataBool | kActionUnmask, 0, 0, 1, {}, std::string(1, '\0')).error,
            0);
  EXPECT_EQ(signals(event), 0U);
  ASSERT_EQ(client.interrupts(kDataBool | kActionUnmask, 0, 0, 1, {}, "\1").error, 0);
  EXPECT_EQ(signals(event), 1U);
}

TEST(Interrupts, AClientTriggersItsOwn) {
  SessionClient client;
  const FileDescriptor event = test::eventfd();
  ASSERT_EQ(client.interrupts(kGive, 1, 0, 1, test::copy_of(event)).error, 0);
  EXPECT_EQ(client.interrupts(kDataNone | kActionTrigger, 1, 0, 1).error, 0);
  EXPECT_EQ(client.interrupts(kDataBool | kActionTrigger, 1, 0, 1, {}, "\1").error, 0);
  EXPECT_EQ(signals(event), 2U);
}

TEST(Interrupts, WhatIsRefused) {
  SessionClient client;
  const auto error = [&client](std::uint32_t flags, std::uint32_t index, std::uint32_t start,
                               std::uint32_t count) {
    return client.interrupts(flags, index, start, count).error;
  };
  EXPECT_EQ(error(0, 1, 0, 1), EINVAL);
  EXPECT_EQ(error(kDataNone | kDataBool | kActionTrigger, 1, 0, 1), EINVAL);
  EXPECT_EQ(error(kDataNone | kActionMask | kActionUnmask, 0, 0, 1), EINVAL);
  EXPECT_EQ(error(kDataNone | kActionTrigger | 64U, 0, 0, 1), EINVAL);
  EXPECT_EQ(error(kGive, 5, 0, 1), EINVAL);
  EXPECT_EQ(error(kGive, 1, 0, 2), EINVAL);
  EXPECT_EQ(error(kGive, 1, 1, 1), EINVAL);
  EXPECT_EQ(error(kGive, 1, ~0U, 2), EINVAL);
  EXPECT_EQ(error(kGive, 2, 0, 1), EINVAL);  // no MSI-X
  EXPECT_EQ(error(kDataNone | kActionMask, 1, 0, 1), ENOTSUP);
  EXPECT_EQ(error(kDataEventfd | kActionUnmask, 0, 0, 1), ENOTSUP);
  EXPECT_EQ(error(kDataBool | kActionTrigger, 1, 0, 1), EINVAL);  // without its byte
  EXPECT_EQ(client.send(Request::device_set_irqs, {1, 2, 3}).error, EINVAL);
}

// A file that is full would hold the server up.
TEST(Interrupts, NothingWaitsForAnEventfd) {
  SessionClient client;
  const FileDescriptor event(::eventfd(0, EFD_CLOEXEC));
  const std::uint64_t full = ~std::uint64_t{1};
  ASSERT_EQ(::write(event.number(), &full, sizeof full), 8);
  ASSERT_EQ(client.interrupts(kGive, 1, 0, 1, test::copy_of(event)).error, 0);
  client.session->interrupts().message();
  EXPECT_EQ(signals(event), full);
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
  const FileDescriptor reader(ends[0]);
  EXPECT_EQ(client.interrupts(kGive, 1, 0, 1, FileDescriptor(ends[1])).error, EINVAL);
}

TEST(Interrupts, ABoardWithoutMessagesHasNone) {
  SessionClient client;
  client.function.messages = false;
  client.session.emplace(client.function);
  client.version(0, 1, "");
  EXPECT_EQ(client.interrupts(kGive, 1, 0, 1, test::eventfd()).error, EINVAL);
}

}  // namespace
}  // namespace hvp::serve::interrupts_test
