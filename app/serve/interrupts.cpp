#include "app/serve/interrupts.h"

#include <array>
#include <bit>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <poll.h>

namespace hvp::serve {

namespace {

constexpr std::uint32_t kDataFlags = kDataNone | kDataBool | kDataEventfd;
constexpr std::uint32_t kActionFlags = kActionMask | kActionUnmask | kActionTrigger;

// A write to any file other than an eventfd may block.
bool is_eventfd(const FileDescriptor& file) {
  std::array<char, 64> target{};
  const std::string link = fmt::format("/proc/self/fd/{}", file.number());
  const ssize_t length = ::readlink(link.c_str(), target.data(), target.size());
  constexpr std::string_view kEventfd = "anon_inode:[eventfd]";
  return length > 0 &&
         std::string_view(target.data(), static_cast<std::size_t>(length)) == kEventfd;
}

// An eventfd whose counter is full has been signalled already.
void signal(const FileDescriptor& event) {
  if (!event) return;
  pollfd ready{.fd = event.number(), .events = POLLOUT, .revents = 0};
  if (::poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) return;
  const std::uint64_t one = 1;
  const ssize_t written = ::write(event.number(), &one, sizeof one);
  static_cast<void>(written);
}

}  // namespace

InterruptInfo Interrupts::info(std::uint32_t index) const {
  if (index >= kInterruptIndices) throw Refused(EINVAL, fmt::format("no interrupt {}", index));
  InterruptInfo info{.argsz = sizeof(InterruptInfo), .flags = 0, .index = index, .count = 0};
  if (index == kLineIndex) {
    info.flags = kByEventfd | kMaskable | kAutoMasked;
    info.count = 1;
  } else if (index == messages_ || (index == kErrorIndex && has_errors_)) {
    info.flags = kByEventfd | kNoResize;
    info.count = 1;
  }
  return info;
}

void Interrupts::set(const SetInterrupts& command, std::span<const std::uint8_t> data,
                     std::vector<FileDescriptor> files) {
  const std::uint32_t what = command.flags & kDataFlags;
  const std::uint32_t action = command.flags & kActionFlags;
  if (!std::has_single_bit(what) || !std::has_single_bit(action) ||
      (command.flags & ~(kDataFlags | kActionFlags)) != 0) {
    throw Refused(EINVAL, fmt::format("flags {:#x} of interrupts", command.flags));
  }
  const std::uint32_t present = info(command.index).count;
  if (command.start > present || command.count > present - command.start) {
    throw Refused(
        EINVAL, fmt::format("interrupts {} to {} of index {}, which has {}", command.start,
                            std::uint64_t{command.start} + command.count, command.index, present));
  }
  if (action != kActionTrigger && (command.index != kLineIndex || what == kDataEventfd)) {
    throw Refused(ENOTSUP, "only INTx is masked, and by no eventfd");
  }
  if (command.count == 0) {
    if (what != kDataNone || action != kActionTrigger) {
      throw Refused(EINVAL, "an action on no interrupt");
    }
    if (present > 0) assign(command.index, {});
    return;
  }
  if (what == kDataEventfd) {
    assign(command.index, std::move(files));
  } else if (what == kDataNone || Fields(data).take<std::uint8_t>() != 0) {
    act(command.index, action);
  }
}

// An index has at most one interrupt.
void Interrupts::assign(std::uint32_t index, std::vector<FileDescriptor> files) {
  if (files.size() > 1) throw Refused(EINVAL, "more files than interrupts");
  if (!files.empty() && !is_eventfd(files.front())) {
    throw Refused(EINVAL, "a file that is no eventfd");
  }
  source(index) = {files.empty() ? FileDescriptor() : std::move(files.front()), false};
  if (index == kLineIndex) show_line();
}

void Interrupts::act(std::uint32_t index, std::uint32_t action) {
  Source& of = source(index);
  if (action == kActionTrigger) {
    signal(of.event);
  } else {
    of.masked = action == kActionMask;
    show_line();
  }
}

void Interrupts::line(bool up) {
  up_ = up;
  show_line();
}

void Interrupts::show_line() {
  if (!up_ || line_.masked || !line_.event) return;
  line_.masked = true;
  signal(line_.event);
}

// NOLINTNEXTLINE(readability-make-member-function-const): the client hears of it
void Interrupts::message() { signal(message_.event); }

// NOLINTNEXTLINE(readability-make-member-function-const): likewise
void Interrupts::error() { signal(error_.event); }

}  // namespace hvp::serve
