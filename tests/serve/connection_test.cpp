#include "app/serve/connection.h"

#include <array>
#include <cerrno>
#include <optional>

#include <gtest/gtest.h>
#include <sys/socket.h>

namespace hvp::serve::connection_test {
namespace {

// What came since the last message was read: a virtual machine's monitor does not survive a
// connection that is reset for it.
TEST(Connection, WhoIsInTheMiddleOfARequestFindsAnEnd) {
  for (const bool finished : {false, true}) {
    std::array<int, 2> ends{};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
    const FileDescriptor client(ends[0]);
    auto connection = std::make_optional<Connection>(FileDescriptor(ends[1]));
    ASSERT_EQ(::send(client.number(), "late", 4, 0), 4);
    if (finished) connection->finish();
    connection.reset();
    char byte = 0;
    errno = 0;
    EXPECT_EQ(::recv(client.number(), &byte, 1, 0), finished ? 0 : -1);
    EXPECT_EQ(errno, finished ? 0 : ECONNRESET);
  }
}

}  // namespace
}  // namespace hvp::serve::connection_test
