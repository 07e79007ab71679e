#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace hvp::guest {

// A part of somebody else's file in this process' memory, shared with who else has it.
class MappedFile {
 public:
  // Throws GuestError where the file has not so many bytes there, or cannot be mapped.
  MappedFile(int descriptor, std::uint64_t offset, std::uint64_t bytes);
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&&) = delete;

  std::span<std::uint8_t> bytes() const { return bytes_; }

 private:
  void* mapping_ = nullptr;  // from the page on in which `bytes_` begin
  std::size_t length_ = 0;
  std::span<std::uint8_t> bytes_;
};

}  // namespace hvp::guest
