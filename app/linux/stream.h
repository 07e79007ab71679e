#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "app/linux/guest_process.h"

namespace hvp::guest {

// A connection to the guest that carries whole messages. Waiting for a message also serves the
// guest's console and ends as GuestProcess::wait_readable() does. Throws GuestGone if the guest has
// closed the connection.
class Stream {
 public:
  Stream() = default;
  Stream(Descriptor descriptor, GuestProcess& process)
      : descriptor_(std::move(descriptor)), process_(&process) {}

  int number() const { return descriptor_.number(); }
  explicit operator bool() const { return static_cast<bool>(descriptor_); }
  // Makes another connection to the same guest.
  Stream beside(Descriptor descriptor) const { return {std::move(descriptor), *process_}; }
  std::size_t wait_readable(std::span<const int> descriptors) const {
    return process_->wait_readable(descriptors);
  }
  void send(std::span<const std::uint8_t> bytes);
  // Fills `bytes`. Descriptors that come with them are appended to `descriptors`, or closed if it
  // is null.
  void receive(std::span<std::uint8_t> bytes, std::vector<Descriptor>* descriptors = nullptr);

 private:
  Descriptor descriptor_;
  GuestProcess* process_ = nullptr;
};

// A socket at a path that accepts one connection. Throws std::runtime_error.
class Listener {
 public:
  explicit Listener(const std::filesystem::path& path);
  int number() const { return descriptor_.number(); }
  // Accepts the connection; nobody can connect afterwards.
  Stream accept(GuestProcess& process);

 private:
  Descriptor descriptor_;
};

}  // namespace hvp::guest
