#include "app/serve/dma_maps.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <iterator>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "app/serve/message.h"

namespace hvp::serve {

namespace {

// The mapped ranges, for the signal handler, which runs within an access and may not allocate.
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

// Maps a page of zeros where the file was truncated; the access is then repeated.
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

namespace {

// The last address of a range; both have been checked.
std::uint64_t last_of(std::uint64_t address, std::uint64_t bytes) { return address + (bytes - 1); }

}  // namespace

DmaMaps::DmaMaps(FunctionPort& function) : function_(function) {
  function_.before_memory([this] { drop_cut_off(); });
}

DmaMaps::~DmaMaps() {
  clear();
  function_.before_memory({});
}

void DmaMaps::drop_cut_off() {
  for (auto& [address, range] : ranges_) {
    if (range.memory.empty() || range.memory.front().whole()) continue;
    spdlog::warn("memory at {:#x}, {} bytes, was cut off: the board cannot reach it", address,
                 range.bytes);
    function_.unmap(address, range.bytes);
    range.memory.clear();
  }
}

bool DmaMaps::overlaps(std::uint64_t address, std::uint64_t bytes) const {
  const auto behind = ranges_.upper_bound(last_of(address, bytes));
  if (behind == ranges_.begin()) return false;
  const auto& [at, range] = *std::prev(behind);
  return last_of(at, range.bytes) >= address;
}

void DmaMaps::map(const DmaMap& command, std::vector<FileDescriptor> files) {
  const auto [argsz, flags, offset, address, bytes] = command;
  if (argsz < sizeof command) throw Refused(EINVAL, "memory without a whole description");
  if (flags == 0 || (flags & ~(kReadable | kWritable)) != 0) {
    throw Refused(EINVAL, fmt::format("flags {:#x} of memory", flags));
  }
  if (bytes == 0 || last_of(address, bytes) < address) {
    throw Refused(EINVAL, fmt::format("memory of {} bytes at {:#x}", bytes, address));
  }
  if (files.size() > 1) throw Refused(EINVAL, "memory of more than one file");
  if (ranges_.size() >= kMostMaps) throw Refused(ENOSPC, "too many ranges of memory");
  if (overlaps(address, bytes)) throw Refused(EEXIST, "memory over other memory");
  Range range{bytes, {}};
  if (files.empty() && (flags & kWritable) == 0) {
    // A virtual machine's ROM, which no driver gives to the board.
    spdlog::debug("memory at {:#x}, {} bytes, is read only and comes without a file", address,
                  bytes);
  } else if (files.empty()) {
    spdlog::warn("memory at {:#x}, {} bytes, comes without a file: the board cannot reach it",
                 address, bytes);
  } else {
    const bool writable = (flags & kWritable) != 0;
    range.memory.emplace_back(std::move(files.front()), offset, bytes, writable);
    try {
      function_.map(address, range.memory.front().bytes(), writable);
    } catch (const std::invalid_argument& e) {
      throw Refused(EINVAL, e.what());
    }
  }
  ranges_.emplace(address, std::move(range));
}

void DmaMaps::unmap(const DmaUnmap& command) {
  const auto [argsz, flags, address, bytes] = command;
  if (argsz < sizeof command) throw Refused(EINVAL, "memory without a whole description");
  if (flags == kUnmapAll && address == 0 && bytes == 0) {
    clear();
    return;
  }
  if (flags != 0) throw Refused(ENOTSUP, fmt::format("flags {:#x} of memory that goes", flags));
  if (bytes == 0 || last_of(address, bytes) < address) {
    throw Refused(EINVAL, fmt::format("memory of {} bytes at {:#x}", bytes, address));
  }
  const std::uint64_t last = last_of(address, bytes);
  const auto first = ranges_.lower_bound(address);
  const auto end = ranges_.upper_bound(last);
  const auto cut = [&](Ranges::const_iterator range, std::uint64_t at) {
    return range->first < at && last_of(range->first, range->second.bytes) >= at;
  };
  if (first != ranges_.begin() && cut(std::prev(first), address)) {
    throw Refused(EINVAL, "a part of a range of memory");
  }
  // As in the kernel's VFIO: QEMU unmaps whatever a virtual IOMMU may have mapped.
  if (first == end) return;
  if (last_of(std::prev(end)->first, std::prev(end)->second.bytes) > last) {
    throw Refused(EINVAL, "a part of a range of memory");
  }
  for (auto range = first; range != end;) range = remove(range);
}

DmaMaps::Ranges::iterator DmaMaps::remove(Ranges::iterator range) {
  if (!range->second.memory.empty()) function_.unmap(range->first, range->second.bytes);
  return ranges_.erase(range);
}

void DmaMaps::clear() {
  while (!ranges_.empty()) remove(ranges_.begin());
}

}  // namespace hvp::serve
