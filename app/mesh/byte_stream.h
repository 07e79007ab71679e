#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/mesh/tet_mesh.h"

// The bytes in which surfaces and meshes go from a child process to its parent: counts, then
// coordinates and indices bit for bit.
namespace hvp::app {

class ByteWriter {
 public:
  void points(const std::vector<Eigen::Vector3d>& values) {
    count(values.size());
    for (const auto& x : values) put(x.data(), 3 * sizeof(double));
  }
  template <std::size_t N>
  void tuples(const std::vector<std::array<int, N>>& values) {
    count(values.size());
    for (const auto& t : values) put(t.data(), N * sizeof(int));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  void count(std::uint64_t n) { put(&n, sizeof n); }
  void put(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(const std::string& bytes) : bytes_(bytes) {}
  std::vector<Eigen::Vector3d> points() {
    std::vector<Eigen::Vector3d> values(count());
    for (auto& x : values) get(x.data(), 3 * sizeof(double));
    return values;
  }
  template <std::size_t N>
  std::vector<std::array<int, N>> tuples() {
    std::vector<std::array<int, N>> values(count());
    for (auto& t : values) get(t.data(), N * sizeof(int));
    return values;
  }

 private:
  std::uint64_t count() {
    std::uint64_t n = 0;
    get(&n, sizeof n);
    // Every item takes at least one byte; a larger count is broken.
    if (n > bytes_.size()) throw std::runtime_error("a child process sent a broken result");
    return n;
  }
  void get(void* data, std::size_t size) {
    if (size > bytes_.size() - at_) {
      throw std::runtime_error("a child process sent a broken result");
    }
    std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  const std::string& bytes_;
  std::size_t at_ = 0;
};

}  // namespace hvp::app
