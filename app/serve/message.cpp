#include "app/serve/message.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace hvp::serve {

namespace {

Bytes message(const Header& header, std::span<const std::uint8_t> body) {
  Bytes bytes;
  bytes.reserve(sizeof header + body.size());
  append(bytes, header);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

}  // namespace

Header parse_header(std::span<const std::uint8_t, sizeof(Header)> bytes) {
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.size < sizeof(Header) || header.size > kLargestMessage) {
    throw Broken(fmt::format("a message of {} bytes: expected {} to {}", header.size,
                             sizeof(Header), kLargestMessage));
  }
  // This server sends no commands, so it expects no replies.
  if ((header.flags & kTypeMask) != 0) {
    throw Broken(fmt::format("a message of type {}: expected a command", header.flags & kTypeMask));
  }
  return header;
}

Bytes reply(const Header& command, std::span<const std::uint8_t> body) {
  return message({.id = command.id,
                  .command = command.command,
                  .size = static_cast<std::uint32_t>(sizeof(Header) + body.size()),
                  .flags = kReplyType,
                  .error = 0},
                 body);
}

Bytes error_reply(const Header& command, int error) {
  return message({.id = command.id,
                  .command = command.command,
                  .size = sizeof(Header),
                  .flags = kReplyType | kErrorFlag,
                  .error = static_cast<std::uint32_t>(error)},
                 {});
}

namespace {

constexpr std::size_t kPageBytes = 4096;

nlohmann::json parse(std::span<const std::uint8_t> text) {
  if (text.empty()) return nlohmann::json::object();
  // The text ends with a NUL, or at the end of the body.
  const auto end = std::ranges::find(text, std::uint8_t{0});
  nlohmann::json data = nlohmann::json::parse(text.begin(), end, nullptr, false);
  if (!data.is_object()) throw Refused(EINVAL, "capabilities that are no JSON object");
  return data;
}

}  // namespace

Agreement agree(std::span<const std::uint8_t> body) {
  Fields fields(body);
  const auto version = fields.take<Version>();
  if (version.major != kMajor) {
    throw Refused(ENOTSUP, fmt::format("version {}.{} of the protocol: expected {}.x",
                                       version.major, version.minor, kMajor));
  }
  const nlohmann::json data = parse(fields.rest());
  const auto capabilities = data.find("capabilities");
  if (capabilities != data.end() && !capabilities->is_object()) {
    throw Refused(EINVAL, "\"capabilities\" is no JSON object");
  }
  Agreement agreement{.minor = std::min(version.minor, kMinor), .writes_multiple = false};
  if (agreement.minor >= 1 && capabilities != data.end()) {
    const auto multiple = capabilities->find("write_multiple");
    agreement.writes_multiple =
        multiple != capabilities->end() && multiple->is_boolean() && multiple->get<bool>();
  }
  return agreement;
}

Bytes version_reply(const Agreement& agreement) {
  nlohmann::json capabilities = {{"max_msg_fds", kMostFiles},
                                 {"max_data_xfer_size", kLargestTransfer},
                                 {"max_dma_maps", kMostMaps},
                                 {"pgsizes", kPageBytes}};
  if (agreement.writes_multiple) capabilities["write_multiple"] = true;
  const std::string text = nlohmann::json{{"capabilities", capabilities}}.dump();
  Bytes body;
  append(body, Version{.major = kMajor, .minor = agreement.minor});
  body.insert(body.end(), text.begin(), text.end());
  body.push_back(0);
  return body;
}

}  // namespace hvp::serve
