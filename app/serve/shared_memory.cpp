#include "app/serve/shared_memory.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <utility>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "app/serve/message.h"

namespace hvp::serve {

namespace {

// What is mapped, for the handler, which may allocate nothing and is called within an access.
struct Mapped {
  std::uintptr_t begin = 0;
  std::uintptr_t end = 0;  // begin: free
};
std::array<Mapped, kMostMaps> mapped;

Mapped* place_of(std::uintptr_t begin, std::uintptr_t end) {
  return std::ranges::find_if(mapped,
                              [=](const Mapped& m) { return m.begin == begin && m.end == end; });
}

bool is_mapped(std::uintptr_t address) {
  return std::ranges::any_of(
      mapped, [=](const Mapped& m) { return address >= m.begin && address < m.end; });
}

// Puts a page of zeros where the file has none any more; the access is then made again.
extern "C" void take_bus_error(int number, siginfo_t* info, void* /*context*/) {
  static const auto page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  if (is_mapped(address)) {
    // NOLINTNEXTLINE(performance-no-int-to-ptr): a page of that address
    void* const page = reinterpret_cast<void*>(address / page_bytes * page_bytes);
    void* const zeros = ::mmap(page, page_bytes, PROT_READ | PROT_WRITE,
                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0);
    if (zeros != MAP_FAILED) return;
  }
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  ::sigaction(number, &action, nullptr);
}

void take_bus_errors() {
  struct sigaction action {};
  action.sa_sigaction = take_bus_error;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGBUS, &action, nullptr);
}

}  // namespace

SharedMemory::SharedMemory(FileDescriptor file, std::uint64_t offset, std::uint64_t bytes,
                           bool writable)
    : file_(std::move(file)), end_(offset + bytes) {
  struct stat status {};
  if (::fstat(file_.number(), &status) != 0) throw Refused(errno, "a file without a state");
  if (!S_ISREG(status.st_mode)) throw Refused(EINVAL, "memory that is no regular file");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (bytes == 0 || offset > size || bytes > size - offset) {
    throw Refused(EINVAL, fmt::format("{} bytes at {} of a file of {} bytes", bytes, offset, size));
  }
  Mapped* const place = place_of(0, 0);
  if (place == mapped.end()) throw Refused(ENOSPC, "too much memory");
  static const bool ready = (take_bus_errors(), true);
  static_cast<void>(ready);
  const int protection = writable ? PROT_READ | PROT_WRITE : PROT_READ;
  void* const memory =
      ::mmap(nullptr, bytes, protection, MAP_SHARED, file_.number(), static_cast<off_t>(offset));
  if (memory == MAP_FAILED) throw Refused(errno, "a file that cannot be mapped");
  bytes_ = {static_cast<std::uint8_t*>(memory), bytes};
  const auto begin = reinterpret_cast<std::uintptr_t>(memory);
  *place = {begin, begin + bytes};
}

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : file_(std::move(other.file_)), end_(other.end_), bytes_(std::exchange(other.bytes_, {})) {}

SharedMemory::~SharedMemory() {
  if (bytes_.empty()) return;
  const auto begin = reinterpret_cast<std::uintptr_t>(bytes_.data());
  *place_of(begin, begin + bytes_.size()) = {};
  ::munmap(bytes_.data(), bytes_.size());
}

bool SharedMemory::whole() const {
  struct stat status {};
  return ::fstat(file_.number(), &status) == 0 &&
         static_cast<std::uint64_t>(status.st_size) >= end_;
}

}  // namespace hvp::serve
