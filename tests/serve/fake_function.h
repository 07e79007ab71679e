#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <stdexcept>
#include <vector>

#include "app/serve/function_port.h"

namespace hvp::test {

// A function whose BAR and configuration space are memory.
class FakeFunction : public serve::FunctionPort {
 public:
  void read_config(std::uint64_t offset, std::span<std::uint8_t> data) override {
    accesses.push_back(data.size());
    std::copy_n(config.begin() + static_cast<std::ptrdiff_t>(offset), data.size(), data.begin());
  }
  void write_config(std::uint64_t offset, std::span<const std::uint8_t> data) override {
    accesses.push_back(data.size());
    std::ranges::copy(data, config.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  std::uint64_t config_bytes() const override { return config.size(); }
  bool read_bar(std::uint64_t offset, std::span<std::uint8_t> data) override {
    accesses.push_back(data.size());
    std::copy_n(bar.begin() + static_cast<std::ptrdiff_t>(offset), data.size(), data.begin());
    return answers;
  }
  bool write_bar(std::uint64_t offset, std::span<const std::uint8_t> data) override {
    accesses.push_back(data.size());
    std::ranges::copy(data, bar.begin() + static_cast<std::ptrdiff_t>(offset));
    return answers;
  }
  std::uint64_t bar_bytes() const override { return bar.size(); }
  std::uint64_t table_bytes() const override { return table.size(); }
  void read_table(std::uint64_t offset, std::span<std::uint8_t> data) override {
    accesses.push_back(data.size());
    std::copy_n(table.begin() + static_cast<std::ptrdiff_t>(offset), data.size(), data.begin());
  }
  void write_table(std::uint64_t offset, std::span<const std::uint8_t> data) override {
    accesses.push_back(data.size());
    std::ranges::copy(data, table.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  void mask_message(bool masked) override { masks.push_back(masked); }
  void map(std::uint64_t address, std::span<std::uint8_t> memory, bool writable) override {
    if (address == kWindow) throw std::invalid_argument("the window of messages");
    if (!maps.emplace(address, Memory{memory, writable}).second) {
      throw std::logic_error("a session maps over what it has mapped");
    }
  }
  void unmap(std::uint64_t address, std::uint64_t bytes) override {
    const auto found = maps.find(address);
    if (found == maps.end() || found->second.bytes.size() != bytes) {
      throw std::logic_error("a session unmaps what it has not mapped");
    }
    maps.erase(found);
  }
  void before_memory(std::function<void()> look) override { look_at_memory = std::move(look); }
  void reset() override { ++resets; }
  bool has_messages() const override { return messages; }
  bool reports_errors() const override { return errors; }
  bool line_is_up() const override { return line; }

  struct Memory {
    std::span<std::uint8_t> bytes;
    bool writable;
  };
  static constexpr std::uint64_t kWindow = 0xfee0'0000;

  std::vector<std::uint8_t> bar = std::vector<std::uint8_t>(std::size_t{2} << 20U);
  std::vector<std::uint8_t> config = std::vector<std::uint8_t>(256);
  std::vector<std::uint8_t> table;    // empty: messages are MSI's
  std::vector<bool> masks;            // of the vector, as they were set
  std::vector<std::size_t> accesses;  // their bytes
  std::map<std::uint64_t, Memory> maps;
  std::function<void()> look_at_memory;
  bool messages = true;
  bool errors = false;
  bool line = false;
  bool answers = true;
  int resets = 0;
};

}  // namespace hvp::test
