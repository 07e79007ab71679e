#include "app/linux/mapped_file.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/linux/guest_error.h"

namespace hvp::guest {

MappedFile::MappedFile(int descriptor, std::uint64_t offset, std::uint64_t bytes) {
  struct stat status {};
  const bool there = fstat(descriptor, &status) == 0 && bytes > 0 && status.st_size > 0 &&
                     offset <= static_cast<std::uint64_t>(status.st_size) &&
                     bytes <= static_cast<std::uint64_t>(status.st_size) - offset;
  if (!there) {
    throw GuestError(fmt::format("the guest's memory of {} bytes is not in its file", bytes));
  }
  const std::uint64_t within = offset % static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  length_ = bytes + within;
  mapping_ = mmap(nullptr, length_, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor,
                  static_cast<off_t>(offset - within));
  if (mapping_ == MAP_FAILED) {
    throw GuestError(fmt::format("the guest's memory cannot be shared: {}",
                                 std::generic_category().message(errno)));
  }
  bytes_ = {static_cast<std::uint8_t*>(mapping_) + within, bytes};
}

MappedFile::~MappedFile() {
  if (mapping_ != nullptr) munmap(mapping_, length_);
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : mapping_(std::exchange(other.mapping_, nullptr)),
      length_(other.length_),
      bytes_(other.bytes_) {}

}  // namespace hvp::guest
