// A session on arbitrary messages, cut out of the bytes as a connection does, with files of several
// kinds. What must hold: it throws nothing but Broken; every reply is a whole message with the id
// of its command; the board is told nothing that it has not; and in the end no file is open that
// was not before, no memory is mapped and the board was reset.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <sys/mman.h>

#include "app/serve/session.h"
#include "tests/serve/fake_function.h"

namespace {

using hvp::serve::Broken;
using hvp::serve::Bytes;
using hvp::serve::FileDescriptor;
using hvp::serve::Header;

void require(bool holds) {
  if (!holds) std::abort();
}

// The lowest free one: it grows with each file that is left open.
int next_file() {
  const FileDescriptor probe(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  return probe.number();
}

// What comes with a message, by the high byte of its header's error, which a command has no use
// for.
std::vector<FileDescriptor> files_of(const Header& header) {
  std::vector<FileDescriptor> files;
  for (std::uint32_t kinds = header.error >> 24U; kinds != 0; kinds >>= 2U) {
    switch (kinds & 3U) {
      case 1:
        files.emplace_back(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
        break;
      case 2:
        files.emplace_back(::memfd_create("fuzz", MFD_CLOEXEC));
        require(::ftruncate(files.back().number(), 1 << 16) == 0);
        break;
      case 3:
        files.emplace_back(::open("/dev/null", O_RDWR | O_CLOEXEC));
        break;
      default:
        break;
    }
  }
  return files;
}

void check_reply(const Header& command, const Bytes& reply) {
  if ((command.flags & hvp::serve::kNoReply) != 0) {
    require(reply.empty());
    return;
  }
  const auto header = hvp::serve::Fields(reply).take<Header>();
  require(header.id == command.id && header.command == command.command);
  require(header.size == reply.size() && reply.size() <= hvp::serve::kLargestMessage);
  require((header.flags & hvp::serve::kTypeMask) == hvp::serve::kReplyType);
}

void play(std::span<const std::uint8_t> bytes, hvp::serve::Session& session,
          hvp::test::FakeFunction& function) {
  while (bytes.size() >= sizeof(Header)) {
    const Header header = hvp::serve::parse_header(bytes.first<sizeof(Header)>());
    if (header.size > bytes.size()) return;  // half a message
    const auto body = bytes.subspan(sizeof(Header), header.size - sizeof(Header));
    check_reply(header, session.take({header, {body.begin(), body.end()}, files_of(header)}));
    bytes = bytes.subspan(header.size);
    // What the board does meanwhile.
    function.line = (header.error & 1U) != 0;
    session.interrupts().line(function.line);
    if ((header.error & 2U) != 0) session.interrupts().message();
    for (const auto& [address, memory] : function.maps) {
      require(!memory.bytes.empty());
    }
    function.look_at_memory();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  spdlog::set_level(spdlog::level::off);
  const int before = next_file();
  hvp::test::FakeFunction function;
  function.bar.resize(4096);
  {
    hvp::serve::Session session(function);
    try {
      play({data, size}, session, function);
    } catch (const Broken&) {
      // The client is let go.
    }
  }
  require(function.resets > 0 && function.maps.empty() && next_file() == before);
  return 0;
}
