// Clients that do wrong, and what is there before and after a server.
#include <csignal>
#include <random>

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/serve/served_program.h"

namespace hvp::serve::robustness_test {
namespace {

using test::RawClient;
using test::ServedProgram;
using ::testing::HasSubstr;

Bytes header_of(std::uint32_t size, std::uint16_t command = 9) {
  Bytes bytes;
  append(bytes, Header{.id = 1, .command = command, .size = size});
  return bytes;
}

TEST(Robustness, RubbishEndsItsClientOnly) {
  ServedProgram served;
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    RawClient client(served.socket());
    if (i % 2 == 0) {
      EXPECT_TRUE(client.agree());
    }
    Bytes rubbish(4096);
    for (std::uint8_t& byte : rubbish) byte = static_cast<std::uint8_t>(random());
    rubbish[7] = 0xff;  // a length that nobody takes
    client.send(rubbish);
    EXPECT_FALSE(client.reply());
  }
  served.expect_service();
}

TEST(Robustness, ALengthOfFourGigabytesIsRefused) {
  ServedProgram served;
  const std::ptrdiff_t before = served.open_files();
  for (const std::uint32_t size : {0xffff'ffffU, 0x8000'0000U, 15U, 0U}) {
    RawClient client(served.socket());
    EXPECT_TRUE(client.agree());
    client.send(header_of(size));
    EXPECT_FALSE(client.reply()) << size;
  }
  served.expect_service();
  RawClient last(served.socket());
  EXPECT_TRUE(last.agree());
  EXPECT_EQ(served.open_files(), before + 1);
}

TEST(Robustness, HalfAMessageIsWaitedForAndDies) {
  ServedProgram served;
  for (const std::size_t part : {1U, 15U, 16U, 20U}) {
    RawClient client(served.socket());
    EXPECT_TRUE(client.agree());
    const Bytes whole = RawClient::message(Request::region_read, Bytes(16));
    client.send(std::span(whole).first(part));
    client.close();
    served.expect_service();
  }
  // Byte by byte it is a message.
  RawClient slow(served.socket());
  EXPECT_TRUE(slow.agree());
  Bytes body;
  append(body, RegionAccess{0, kConfigRegion, 4});
  for (const std::uint8_t byte : RawClient::message(Request::region_read, body)) {
    slow.send({&byte, 1});
  }
  ASSERT_TRUE(slow.reply());
}

TEST(Robustness, ASecondClientIsToldSo) {
  ServedProgram served;
  RawClient first(served.socket());
  EXPECT_TRUE(first.agree());
  RawClient second(served.socket());
  const std::optional<Header> answer = second.reply();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->error, static_cast<std::uint32_t>(EBUSY));
  EXPECT_FALSE(second.reply());
  Bytes body;
  append(body, DeviceInfo{.argsz = 16});
  first.send(Request::device_get_info, body);
  EXPECT_TRUE(first.reply());
  first.close();
  served.expect_service();
  const cli::Ended ended = served.end_by(SIGTERM);
  EXPECT_THAT(ended.err, HasSubstr("a second client was refused"));
}

// Replies without end for a client that reads none.
TEST(Robustness, AClientThatReadsNothingIsLetGo) {
  ServedProgram served;
  RawClient client(served.socket());
  EXPECT_TRUE(client.agree());
  Bytes body;
  append(body, RegionAccess{0x20000, kBarRegion, 65536});
  const Bytes message = RawClient::message(Request::region_read, body);
  for (int i = 0; i < 40; ++i) client.send(message);
  RawClient next(served.socket());  // waits in the queue, or is refused
  client.close();
  next.close();
  served.expect_service();
}

TEST(Robustness, EndsAtASignalAndTakesItsSocketAlong) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    for (const bool connected : {false, true}) {
      ServedProgram served;
      std::optional<RawClient> client;
      if (connected) {
        client.emplace(served.socket());
        EXPECT_TRUE(client->agree());
      }
      const cli::Ended ended = served.end_by(number);
      EXPECT_EQ(ended.signal, number);
      EXPECT_FALSE(std::filesystem::exists(served.socket()));
      EXPECT_THAT(ended.err, HasSubstr("hvp: interrupted"));
      EXPECT_EQ(cli::lines(ended.err).size(), 1U) << ended.err;
    }
  }
}

TEST(Robustness, OnceEndsWithTheFirstClientThatSpoke) {
  ServedProgram served({"--once"});
  RawClient(served.socket()).close();  // only looked
  RawClient client(served.socket());
  EXPECT_TRUE(client.agree());
  client.close();
  const cli::Ended ended = served.program().wait();
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err, "");
  EXPECT_THAT(ended.out, HasSubstr("not for timing"));
  EXPECT_FALSE(std::filesystem::exists(served.socket()));
}

TEST(ServeSocket, IsItsUsersAlone) {
  ServedProgram served;
  struct stat status {};
  ASSERT_EQ(::stat(served.socket().c_str(), &status), 0);
  EXPECT_TRUE(S_ISSOCK(status.st_mode));
  EXPECT_EQ(status.st_mode & 0777, 0600U);
}

TEST(ServeSocket, OfALiveServerIsLeftAlone) {
  ServedProgram served;
  const cli::Ended second =
      cli::hvp(served.folder(), {"serve", "s.toml", "--quiet", "--vfio-user", "board"});
  EXPECT_EQ(second.status, 2);
  EXPECT_EQ(cli::lines(second.err).size(), 1U) << second.err;
  EXPECT_THAT(second.err, HasSubstr("--vfio-user board: a server listens there already"));
  served.expect_service();
}

TEST(ServeSocket, OfADeadServerIsReplaced) {
  ServedProgram served;
  served.program().kill();
  served.program().wait();
  ASSERT_TRUE(std::filesystem::exists(served.socket()));
  cli::Program again(served.folder(), {"serve", "s.toml", "--once", "--vfio-user", "board"});
  while (again.out().empty() && !again.ended()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  served.expect_service();
  EXPECT_EQ(again.wait().status, 0);
}

TEST(ServeSocket, OneThatAnotherPutThereIsLeftAlone) {
  ServedProgram served;
  std::filesystem::remove(served.socket());
  cli::write(served.socket(), "mine");
  served.end_by(SIGTERM);
  EXPECT_EQ(cli::read(served.socket()), "mine");
}

TEST(ServeSocket, WrongPathsAreOneLineAndStatusTwo) {
  const ScratchDirectory place;
  cli::write(place.path() / "s.toml", cli::kSmallScene);
  cli::write(place.path() / "file", "");
  const std::string far(120, 'x');
  for (const auto& [path, line] : {std::pair<std::string, std::string>{"file", "is no socket"},
                                   {"none/board", "No such file or directory"},
                                   {far, "a path of 120 bytes: a socket's has at most 107"},
                                   {".", "is no socket"}}) {
    const cli::Ended ended =
        cli::hvp(place.path(), {"serve", "s.toml", "--vfio-user", path, "--quiet"});
    EXPECT_EQ(ended.status, 2) << path;
    EXPECT_EQ(cli::lines(ended.err).size(), 1U) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(line));
    EXPECT_EQ(ended.out, "");
  }
  EXPECT_EQ(cli::read(place.path() / "file"), "");
}

TEST(ServeScenario, WithoutABoardIsRefusedByItsKey) {
  const ScratchDirectory place;
  cli::write(place.path() / "s.toml", cli::kSmallScene);
  const cli::Ended ended = cli::hvp(
      place.path(), {"serve", "s.toml", "--vfio-user", "b", "--set", "host.solver=\"host\""});
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("host.solver"));
  EXPECT_FALSE(std::filesystem::exists(place.path() / "b"));
}

}  // namespace
}  // namespace hvp::serve::robustness_test
