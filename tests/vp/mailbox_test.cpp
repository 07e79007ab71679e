#include <vector>

#include <gtest/gtest.h>

#include "vp/host/exchange.h"

namespace hvp::vp::mailbox_test {
namespace {

void put(Mailbox<int>& box, int value, Picoseconds now) {
  box.prepare(now) = value;
  box.publish(now);
}

TEST(Mailbox, ShowsWhatWasPublishedStrictlyBefore) {
  Mailbox<int> box(1);
  EXPECT_EQ(box.read(0), 1);
  put(box, 2, 100);
  EXPECT_EQ(box.read(100), 1);
  EXPECT_EQ(box.read(101), 2);
  EXPECT_EQ(box.read(200), 2);
}

TEST(Mailbox, OrderOfReadAndPublishAtOneInstantDoesNotShow) {
  Mailbox<int> reader_first(1);
  Mailbox<int> writer_first(1);
  const int a = reader_first.read(50);
  put(reader_first, 2, 50);
  put(writer_first, 2, 50);
  const int b = writer_first.read(50);
  EXPECT_EQ(a, b);
  EXPECT_EQ(reader_first.read(51), writer_first.read(51));
}

TEST(Mailbox, LatestOfSeveralCounts) {
  Mailbox<int> box(1);
  put(box, 2, 10);
  put(box, 3, 20);
  EXPECT_EQ(box.read(20), 2);
  put(box, 4, 30);
  put(box, 5, 30);
  EXPECT_EQ(box.read(30), 3);
  EXPECT_EQ(box.read(31), 5);
}

TEST(Mailbox, BuffersAreUsedAgain) {
  Mailbox<std::vector<double>> box(std::vector<double>(1'000));
  std::vector<const double*> buffers;
  for (Picoseconds now = 1; now < 10; ++now) {
    std::vector<double>& next = box.prepare(now);
    next.assign(1'000, static_cast<double>(now));
    buffers.push_back(next.data());
    box.publish(now);
    EXPECT_EQ(box.read(now + 1)[999], static_cast<double>(now));
  }
  for (std::size_t i = 2; i < buffers.size(); ++i) EXPECT_EQ(buffers[i], buffers[i - 2]);
}

}  // namespace
}  // namespace hvp::vp::mailbox_test
