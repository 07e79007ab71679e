#include "app/serve/session.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace hvp::serve {

namespace {

template <class T>
Bytes bytes_of(const T& value) {
  Bytes bytes;
  append(bytes, value);
  return bytes;
}

// Some clients read configuration space, or a table, in blocks, which are split into the accesses
// of a bus.
template <class Byte, class Visit>
void each_bus_access(std::uint64_t offset, std::span<Byte> data, const Visit& visit) {
  while (!data.empty()) {
    std::size_t bytes = std::min<std::size_t>(data.size(), 4);
    while (!std::has_single_bit(bytes) || offset % bytes != 0) --bytes;
    visit(offset, data.first(bytes));
    offset += bytes;
    data = data.subspan(bytes);
  }
}

std::optional<std::uint32_t> message_index(const FunctionPort& function) {
  if (!function.has_messages()) return std::nullopt;
  return function.table_bytes() > 0 ? kTableMessageIndex : kMessageIndex;
}

// Whether files are given for the interrupts, or taken away.
bool assigns(const SetInterrupts& command) {
  return (command.flags & kDataEventfd) != 0 || command.count == 0;
}

}  // namespace

Session::Session(FunctionPort& function)
    : function_(function),
      interrupts_(message_index(function), function.reports_errors()),
      memory_(function) {}

// The board has to be quiet before its memory is removed.
Session::~Session() { function_.reset(); }

Bytes Session::take(Message message) {
  const bool wants_reply = (message.header.flags & kNoReply) == 0;
  if (!open_ && message.header.command != static_cast<std::uint16_t>(Request::version)) {
    throw Broken(fmt::format("command {} before the version", message.header.command));
  }
  try {
    if (message.files.size() > kMostFiles) throw Refused(EINVAL, "too many files");
    const Bytes body = answer(message);
    return wants_reply ? reply(message.header, body) : Bytes();
  } catch (const Refused& e) {
    spdlog::debug("command {} refused: {}", message.header.command, e.what());
    return wants_reply ? error_reply(message.header, e.error()) : Bytes();
  }
}

Bytes Session::answer(Message& message) {
  Fields fields(message.body);
  switch (static_cast<Request>(message.header.command)) {
    case Request::version:
      return begin(message);
    case Request::dma_map:
      memory_.map(fields.take<DmaMap>(), std::move(message.files));
      return {};
    case Request::dma_unmap: {
      const auto command = fields.take<DmaUnmap>();
      memory_.unmap(command);
      return bytes_of(command);
    }
    case Request::device_get_info:
      if (fields.take<std::uint32_t>() < sizeof(DeviceInfo)) {
        throw Refused(EINVAL, "no room for what the device is");
      }
      return bytes_of(DeviceInfo{.argsz = sizeof(DeviceInfo),
                                 .flags = kDeviceResets | kDevicePci,
                                 .regions = kRegions,
                                 .interrupts = kInterruptIndices});
    case Request::device_get_region_info:
      return describe_region(fields);
    case Request::device_get_irq_info:
      return describe_interrupt(fields);
    case Request::device_set_irqs:
      set_interrupts(message);
      return {};
    case Request::region_read:
      return read(fields);
    case Request::region_write:
      return write(fields);
    case Request::device_reset:
      function_.reset();
      return {};
    case Request::region_write_multi:
      return write_multiple(fields);
  }
  throw Refused(ENOTSUP, "a command that this server has not");
}

Bytes Session::begin(const Message& message) {
  if (open_) throw Refused(EINVAL, "a second version");
  agreement_ = agree(message.body);
  open_ = true;
  return version_reply(agreement_);
}

std::uint64_t Session::region_bytes(std::uint32_t region) const {
  if (region == kBarRegion) return function_.bar_bytes();
  if (region == kTableRegion) return function_.table_bytes();
  return region == kConfigRegion ? function_.config_bytes() : 0;
}

Bytes Session::describe_region(Fields fields) const {
  const auto asked = fields.take<RegionInfo>();
  if (asked.argsz < sizeof asked || asked.index >= kRegions) {
    throw Refused(EINVAL, fmt::format("region {} in {} bytes", asked.index, asked.argsz));
  }
  const std::uint64_t bytes = region_bytes(asked.index);
  return bytes_of(RegionInfo{.argsz = sizeof(RegionInfo),
                             .flags = bytes > 0 ? kRegionReadable | kRegionWritable : 0,
                             .index = asked.index,
                             .capabilities = 0,
                             .size = bytes,
                             .offset = 0});
}

Bytes Session::describe_interrupt(Fields fields) const {
  const auto asked = fields.take<InterruptInfo>();
  if (asked.argsz < sizeof asked) throw Refused(EINVAL, "no room for what the interrupt is");
  return bytes_of(interrupts_.info(asked.index));
}

void Session::set_interrupts(Message& message) {
  Fields fields(message.body);
  const auto command = fields.take<SetInterrupts>();
  if (command.argsz < sizeof command) {
    throw Refused(EINVAL, fmt::format("interrupts in {} bytes", command.argsz));
  }
  const bool given = !message.files.empty();
  interrupts_.set(command, fields.rest(), std::move(message.files));
  if (command.index == kTableMessageIndex && assigns(command) && function_.table_bytes() > 0) {
    function_.mask_message(!given);
  }
  interrupts_.line(function_.line_is_up());
}

void Session::check(const RegionAccess& access) const {
  const std::uint64_t bytes = region_bytes(access.region);
  if (access.count == 0 || access.count > kLargestTransfer || access.offset > bytes ||
      access.count > bytes - access.offset) {
    throw Refused(EINVAL, fmt::format("{} bytes at {:#x} of region {}, which has {}", access.count,
                                      access.offset, access.region, bytes));
  }
}

Bytes Session::read(Fields fields) {
  const auto access = fields.take<RegionAccess>();
  check(access);
  Bytes body = bytes_of(access);
  body.resize(sizeof access + access.count);
  const std::span<std::uint8_t> data = std::span(body).subspan(sizeof access);
  if (access.region == kConfigRegion) {
    each_bus_access(access.offset, data, [this](std::uint64_t at, std::span<std::uint8_t> part) {
      function_.read_config(at, part);
    });
  } else if (access.region == kTableRegion) {
    each_bus_access(access.offset, data, [this](std::uint64_t at, std::span<std::uint8_t> part) {
      function_.read_table(at, part);
    });
  } else if (!function_.read_bar(access.offset, data)) {
    throw Refused(EIO, "the board does not answer any more");
  }
  return body;
}

Bytes Session::write(Fields fields) {
  const auto access = fields.take<RegionAccess>();
  check(access);
  write(access, fields.take_bytes(access.count));
  return bytes_of(access);
}

void Session::write(const RegionAccess& access, std::span<const std::uint8_t> data) {
  if (access.region == kConfigRegion) {
    each_bus_access(access.offset, data,
                    [this](std::uint64_t at, std::span<const std::uint8_t> part) {
                      function_.write_config(at, part);
                    });
  } else if (access.region == kTableRegion) {
    each_bus_access(access.offset, data,
                    [this](std::uint64_t at, std::span<const std::uint8_t> part) {
                      function_.write_table(at, part);
                    });
  } else if (!function_.write_bar(access.offset, data)) {
    throw Refused(EIO, "the board does not answer any more");
  }
}

// Writes before a refused one are made.
Bytes Session::write_multiple(Fields fields) {
  if (!agreement_.writes_multiple) throw Refused(ENOTSUP, "several writes were not agreed");
  const auto count = fields.take<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto access = fields.take<RegionAccess>();
    const auto data = fields.take_bytes(kSmallWrite);
    check(access);
    if (access.count > kSmallWrite) throw Refused(EINVAL, "a small write of more than 8 bytes");
    write(access, data.first(access.count));
  }
  return bytes_of(count);
}

}  // namespace hvp::serve
