#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/eventfd.h>
#include <sys/mman.h>

#include "app/serve/session.h"
#include "tests/serve/fake_function.h"

namespace hvp::test {

inline serve::FileDescriptor eventfd() {
  return serve::FileDescriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
}
inline serve::FileDescriptor memfd(std::uint64_t bytes) {
  serve::FileDescriptor file(::memfd_create("hvp-test", MFD_CLOEXEC));
  EXPECT_EQ(::ftruncate(file.number(), static_cast<off_t>(bytes)), 0);
  return file;
}
inline serve::FileDescriptor copy_of(const serve::FileDescriptor& file) {
  return serve::FileDescriptor(::dup(file.number()));
}
// How often it was signalled since it was asked last.
inline std::uint64_t signals(const serve::FileDescriptor& event) {
  std::uint64_t count = 0;
  return ::read(event.number(), &count, sizeof count) == sizeof count ? count : 0;
}
inline std::ptrdiff_t open_files() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return std::distance(begin(files), end(files));
}
template <class... Values>
serve::Bytes bytes_of(const Values&... values) {
  serve::Bytes bytes;
  (serve::append(bytes, values), ...);
  return bytes;
}
inline serve::Bytes with_text(serve::Bytes bytes, std::string_view text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
  return bytes;
}

struct Answer {
  int error = 0;
  serve::Bytes body;
  template <class T>
  T as() const {
    return serve::Fields(body).take<T>();
  }
};

// One client of a session, without a socket.
class SessionClient {
 public:
  // `table_bytes`: of the table of MSI-X; 0: there is none.
  explicit SessionClient(bool open = true, std::size_t table_bytes = 0) {
    if (table_bytes > 0) {
      function.table.resize(table_bytes);
      session.emplace(function);
    }
    if (open) version(0, 1, R"({"capabilities":{"write_multiple":true}})");
  }

  Answer version(std::uint16_t major, std::uint16_t minor, std::string_view text) {
    return send(serve::Request::version, with_text(bytes_of(serve::Version{major, minor}), text));
  }
  Answer send(serve::Request command, const serve::Bytes& body,
              std::optional<serve::FileDescriptor> file = std::nullopt) {
    std::vector<serve::FileDescriptor> files;
    if (file) files.push_back(std::move(*file));
    return send(command, body, std::move(files));
  }
  Answer send(serve::Request command, const serve::Bytes& body,
              std::vector<serve::FileDescriptor> files) {
    const serve::Header header{.id = ++id,
                               .command = static_cast<std::uint16_t>(command),
                               .size = static_cast<std::uint32_t>(sizeof header + body.size())};
    const serve::Bytes reply = session->take({header, body, std::move(files)});
    serve::Fields fields(reply);
    const auto head = fields.take<serve::Header>();
    EXPECT_EQ(head.id, id);
    EXPECT_EQ(head.command, header.command);
    EXPECT_EQ(head.size, reply.size());
    EXPECT_EQ(head.flags & serve::kTypeMask, serve::kReplyType);
    EXPECT_EQ((head.flags & serve::kErrorFlag) != 0, head.error != 0);
    const auto rest = fields.rest();
    return {static_cast<int>(head.error), {rest.begin(), rest.end()}};
  }
  Answer map(std::uint64_t address, std::uint64_t size, serve::FileDescriptor file,
             std::uint32_t flags = serve::kReadable | serve::kWritable, std::uint64_t offset = 0) {
    return send(serve::Request::dma_map,
                bytes_of(serve::DmaMap{sizeof(serve::DmaMap), flags, offset, address, size}),
                std::move(file));
  }
  Answer unmap(std::uint64_t address, std::uint64_t size, std::uint32_t flags = 0) {
    return send(serve::Request::dma_unmap,
                bytes_of(serve::DmaUnmap{sizeof(serve::DmaUnmap), flags, address, size}));
  }
  Answer interrupts(std::uint32_t flags, std::uint32_t index, std::uint32_t start,
                    std::uint32_t count, std::optional<serve::FileDescriptor> file = std::nullopt,
                    std::string_view data = "") {
    return send(serve::Request::device_set_irqs,
                with_text(bytes_of(serve::SetInterrupts{sizeof(serve::SetInterrupts), flags, index,
                                                        start, count}),
                          data),
                std::move(file));
  }

  FakeFunction function;
  std::optional<serve::Session> session{std::in_place, function};
  std::uint16_t id = 0;
};

}  // namespace hvp::test
