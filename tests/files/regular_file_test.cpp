#include "models/files/regular_file.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "models/config/input_error.h"
#include "tests/app/scratch_directory.h"

// A reader that waits for a pipe would make these tests run into ctest's time limit.
namespace hvp::files::regular_file_test {
namespace {

namespace fs = std::filesystem;

std::string refusal(const fs::path& file, std::uintmax_t most_bytes = 100) {
  std::string of_check = "none";
  try {
    require_regular_file(file, "a thing");
  } catch (const InputError& error) {
    of_check = error.what();
  }
  try {
    read_regular_file(file, most_bytes, "a thing");
  } catch (const InputError& error) {
    if (of_check != "none") {
      EXPECT_EQ(of_check, error.what());
    }
    return error.what();
  }
  EXPECT_EQ(of_check, "none");
  return "none";
}

class RegularFile : public ::testing::Test {
 protected:
  fs::path write(const char* name, const std::string& text) {
    std::ofstream(place_.path() / name, std::ios::binary) << text;
    return place_.path() / name;
  }
  fs::path link_to(const fs::path& target) {
    const fs::path first = place_.path() / "first";
    const fs::path second = place_.path() / "second";
    fs::remove(first);
    fs::remove(second);
    fs::create_symlink(target, first);
    fs::create_symlink(first, second);
    return second;
  }

  ScratchDirectory place_;
};

TEST_F(RegularFile, IsReadWhole) {
  const std::string bytes("a\0b\r\n\xff", 6);
  EXPECT_EQ(read_regular_file(write("a", bytes), 6, "a thing"), bytes);
  EXPECT_EQ(read_regular_file(link_to(write("a", bytes)), 6, "a thing"), bytes);
  EXPECT_EQ(read_regular_file(write("a", ""), 0, "a thing"), "");
  const std::string long_text(1'000'000, 'x');
  EXPECT_EQ(read_regular_file(write("a", long_text), 1'000'000, "a thing"), long_text);
}

TEST_F(RegularFile, OfMoreBytesThanAllowedIsRefused) {
  EXPECT_EQ(refusal(write("a", std::string(100, 'x'))), "none");
  EXPECT_EQ(refusal(write("a", std::string(101, 'x'))), "is too large: expected at most 100 bytes");
  // A hole of a terabyte: what it claims is enough.
  const fs::path large = write("large", "");
  fs::resize_file(large, std::uintmax_t{1} << 40U);
  EXPECT_EQ(refusal(large, 3U << 20U), "is too large: expected at most 3 MiB");
}

// The kernel's files claim to be empty, as one may that somebody writes meanwhile.
TEST_F(RegularFile, WhatItClaimsIsNotBelieved) {
  ASSERT_EQ(fs::file_size("/proc/self/status"), 0U);
  EXPECT_THAT(read_regular_file("/proc/self/status", 1U << 20U, "a thing"),
              ::testing::StartsWith("Name:"));
  EXPECT_EQ(refusal("/proc/self/status", 10), "is too large: expected at most 10 bytes");
}

TEST_F(RegularFile, APipeIsNotWaitedFor) {
  const fs::path pipe = place_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string message = "is a pipe: expected a thing in a regular file";
  EXPECT_EQ(refusal(pipe), message);
  EXPECT_EQ(refusal(link_to(pipe)), message);
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  EXPECT_EQ(refusal("/proc/self/fd/" + std::to_string(ends[0])), message);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST_F(RegularFile, DevicesFoldersAndSocketsAreRefused) {
  for (const char* device : {"/dev/zero", "/dev/null", "/dev/tty"}) {
    EXPECT_EQ(refusal(device), "is a device: expected a thing in a regular file") << device;
    EXPECT_EQ(refusal(link_to(device)), "is a device: expected a thing in a regular file");
  }
  EXPECT_EQ(refusal(place_.path()), "is a folder: expected a thing");
  EXPECT_EQ(refusal(link_to("/")), "is a folder: expected a thing");
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = (place_.path() / "socket").string();
  ASSERT_LT(name.size(), sizeof address.sun_path);
  name.copy(static_cast<char*>(address.sun_path), name.size());
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(refusal(name), "is a socket: expected a thing in a regular file");
  ::close(socket);
}

TEST_F(RegularFile, WhatIsNotThereOrCannotBeReadIsRefused) {
  EXPECT_EQ(refusal(place_.path() / "none"), "no such file: expected a thing");
  EXPECT_EQ(refusal(write("a", "x") / "b"), "no such file: expected a thing");
  EXPECT_EQ(refusal(link_to(place_.path() / "none")), "no such file: expected a thing");
  EXPECT_EQ(refusal(""), "no such file: expected a thing");
  fs::create_symlink("loop", place_.path() / "loop");
  EXPECT_EQ(refusal(place_.path() / "loop"), "cannot be read: Too many levels of symbolic links");
  // Regular by its name, and reading it fails.
  EXPECT_EQ(refusal("/proc/self/mem"), "cannot be read: Input/output error");
}

}  // namespace
}  // namespace hvp::files::regular_file_test
