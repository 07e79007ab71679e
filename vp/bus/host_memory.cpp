#include "vp/bus/host_memory.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "vp/bus/weak_memory.h"

namespace hvp::vp {

namespace {

bool plain(const tlm::tlm_generic_payload& transaction) {
  return transaction.get_byte_enable_ptr() == nullptr && transaction.get_data_length() > 0 &&
         transaction.get_streaming_width() >= transaction.get_data_length();
}

std::size_t outside_the_window(std::size_t bytes) {
  if (bytes > kMessageAddress) {
    throw std::invalid_argument("the host's memory reaches into the window of messages");
  }
  return bytes;
}

}  // namespace

HostMemory::HostMemory(const sc_core::sc_module_name& name, std::size_t bytes)
    : sc_module(name),
      from_bus("from_bus"),
      interrupt("interrupt"),
      bytes_(outside_the_window(bytes)) {
  from_bus.register_b_transport(this, &HostMemory::b_transport);
  if (bytes > 0) ranges_.push_back({0, bytes_, true});
}

void HostMemory::map(std::uint64_t address, std::span<std::uint8_t> memory, bool writable) {
  if (memory.empty()) throw std::invalid_argument("a range of memory without a byte");
  const std::uint64_t last = address + (memory.size() - 1);
  if (last < address) throw std::invalid_argument("a range of memory beyond the last address");
  const std::uint64_t last_message = kMessageAddress + kMessageBytes - 1;
  if (address <= last_message && last >= kMessageAddress) {
    throw std::invalid_argument("a range of memory reaches into the window of messages");
  }
  const auto next = std::ranges::upper_bound(ranges_, address, {}, &Range::address);
  const bool behind = next != ranges_.end() && next->address <= last;
  const bool before = next != ranges_.begin() &&
                      address - std::prev(next)->address < std::prev(next)->memory.size();
  if (behind || before) throw std::invalid_argument("a range of memory overlaps another one");
  ranges_.insert(next, {address, memory, writable});
  for (MemoryObserver* const observer : observers_)
    observer->mapped(address, memory.size(), writable);
}

bool HostMemory::unmap(std::uint64_t address, std::uint64_t bytes) {
  const auto inside = [=](const Range& range) {
    return range.address >= address && range.address - address < bytes &&
           range.memory.size() <= bytes - (range.address - address);
  };
  const auto outside = [=](const Range& range) {
    if (range.address >= address) return range.address - address >= bytes;
    return address - range.address >= range.memory.size();
  };
  const bool clean = std::ranges::all_of(
      ranges_, [&](const Range& range) { return inside(range) || outside(range); });
  if (!clean) return false;
  std::erase_if(ranges_, inside);
  for (MemoryObserver* const observer : observers_) observer->unmapped(address, bytes);
  return true;
}

const HostMemory::Range* HostMemory::range_at(std::uint64_t address) const {
  const auto next = std::ranges::upper_bound(ranges_, address, {}, &Range::address);
  if (next == ranges_.begin()) return nullptr;
  const Range& range = *std::prev(next);
  return address - range.address < range.memory.size() ? &range : nullptr;
}

// Visits the memory of each range that has a part of it, in order; false, after some perhaps, if
// not all of it is mapped.
template <class Visit>
bool HostMemory::each_part(std::uint64_t first, std::size_t length, bool write,
                           const Visit& visit) const {
  for (std::size_t done = 0; done < length;) {
    if (first + done < first) return false;
    const Range* const range = range_at(first + done);
    if (range == nullptr || (write && !range->writable)) return false;
    const std::size_t at = first + done - range->address;
    const std::size_t part = std::min(length - done, range->memory.size() - at);
    visit(range->memory.data() + at, done, part);
    done += part;
  }
  return true;
}

bool HostMemory::holds(std::uint64_t first, std::size_t length, bool write) const {
  return each_part(first, length, write, [](auto...) {});
}

void HostMemory::get(std::uint64_t first, std::span<std::uint8_t> data) const {
  each_part(first, data.size(), false,
            [&](const std::uint8_t* memory, std::size_t at, std::size_t part) {
              std::memcpy(data.data() + at, memory, part);
            });
}

void HostMemory::put(std::uint64_t first, std::span<const std::uint8_t> data) {
  each_part(first, data.size(), true, [&](std::uint8_t* memory, std::size_t at, std::size_t part) {
    std::memcpy(memory, data.data() + at, part);
  });
}

bool HostMemory::copy(std::uint64_t address, std::span<std::uint8_t> data) const {
  if (!holds(address, data.size(), false)) return false;
  get(address, data);
  return true;
}

// All of it or nothing.
bool HostMemory::move(tlm::tlm_generic_payload& transaction) {
  const std::uint64_t first = transaction.get_address();
  const std::span<std::uint8_t> data(transaction.get_data_ptr(), transaction.get_data_length());
  const bool write = transaction.is_write();
  if (!holds(first, data.size(), write)) return false;
  bool unordered = false;
  if (transaction.is_read()) {
    get(first, data);
    if (order_ != nullptr) unordered = order_->read(first, data);
  } else if (write && order_ != nullptr) {
    // The board's own words stay as they are: its log has what it wrote.
    ordered_.assign(data.begin(), data.end());
    unordered = order_->write(first, ordered_);
    put(first, ordered_);
  } else if (write) {
    put(first, data);
  }
  if (unordered) {
    for (MemoryObserver* const observer : observers_) {
      observer->unordered(!write, first, data.size());
    }
  }
  return true;
}

void HostMemory::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& /*delay*/) {
  const std::size_t length = transaction.get_data_length();
  unsigned char* const data = transaction.get_data_ptr();
  if (!plain(transaction)) {
    transaction.set_response_status(tlm::TLM_BURST_ERROR_RESPONSE);
    if (transaction.is_read() && data != nullptr) std::memset(data, 0xff, length);
    return;
  }
  const bool allowed = !allowed_ || allowed_();
  if (allowed && take_message(transaction)) {
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
    return;
  }
  const bool read = transaction.is_read();
  const std::uint64_t address = transaction.get_address();
  for (MemoryObserver* const observer : observers_) observer->to_be_moved(read, address, length);
  const bool answered = answer(transaction, allowed);
  for (MemoryObserver* const observer : observers_) {
    observer->moved(read, address, {data, length}, answered);
  }
}

// Returns false for what was refused.
bool HostMemory::answer(tlm::tlm_generic_payload& transaction, bool allowed) {
  const std::size_t length = transaction.get_data_length();
  std::string why;
  if (!allowed) {
    why = "the function is no bus master (COMMAND)";
  } else if (why_not_) {
    why = why_not_(transaction.get_address(), length, transaction.is_write());
  }
  if (why.empty() && move(transaction)) {
    transaction.set_response_status(tlm::TLM_OK_RESPONSE);
    return true;
  }
  transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  const std::string text = refusal(transaction, why);
  spdlog::warn(text);
  for (MemoryObserver* const observer : observers_) observer->refused(text, allowed);
  if (transaction.is_read()) std::memset(transaction.get_data_ptr(), 0xff, length);
  return false;
}

std::string HostMemory::refusal(tlm::tlm_generic_payload& transaction,
                                const std::string& why) const {
  const std::uint64_t address = transaction.get_address();
  const std::uint64_t last = address + transaction.get_data_length() - 1;
  const std::int64_t job = frame_of(transaction);
  std::string text =
      fmt::format("the board's {} of {} bytes at {:#x}, {}, at {}.{:03} ns was refused: ",
                  transaction.is_write() ? "write" : "read", transaction.get_data_length(), address,
                  job < 0 ? std::string("in no job") : fmt::format("in job {}", job),
                  now_ps() / 1000, now_ps() % 1000);
  if (!why.empty()) return text + why;
  const auto distance = [=](const Range& range) {
    const std::uint64_t end = range.address + (range.memory.size() - 1);
    if (end < address) return address - end;
    return range.address > last ? range.address - last : 0;
  };
  const auto nearest = std::ranges::min_element(ranges_, {}, distance);
  if (nearest == ranges_.end()) return text + "no memory is mapped";
  return text + fmt::format("{} {:#x} to {:#x}{}",
                            distance(*nearest) == 0 ? "it is not all in the memory from"
                                                    : "the nearest memory is from",
                            nearest->address, nearest->address + (nearest->memory.size() - 1),
                            nearest->writable ? "" : ", which is not writable");
}

bool HostMemory::take_message(tlm::tlm_generic_payload& transaction) {
  if (!transaction.is_write() || transaction.get_address() != kMessageAddress ||
      transaction.get_data_length() != kMessageBytes) {
    return false;
  }
  ++messages_;
  Tag none;
  if (interrupt.size() > 0) interrupt->interrupt(tag_of(transaction, none));
  return true;
}

}  // namespace hvp::vp
