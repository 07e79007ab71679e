#include "app/record/record.h"

#include <boost/crc.hpp>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "app/scenario/message.h"
#include "models/config/input_error.h"
#include "models/files/regular_file.h"

namespace hvp::record {

namespace {

constexpr std::string_view kMagic = "HVPRECRD";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeadBytes = 24;       // before the scenario's text
constexpr std::size_t kEntryHeadBytes = 24;  // before an entry's data
constexpr std::size_t kSumBytes = 4;
constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 30U;
// Eleven days, so that later times still fit into 64 bits.
constexpr std::uint64_t kLatest = 1'000'000'000'000'000'000;

void put(std::string& bytes, std::uint64_t number, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) bytes += static_cast<char>(number >> 8 * i & 0xffU);
}

std::uint64_t number_at(std::string_view bytes, std::size_t at, std::size_t count) {
  std::uint64_t number = 0;
  for (std::size_t i = count; i > 0; --i) {
    number = number << 8U | static_cast<unsigned char>(bytes[at + i - 1]);
  }
  return number;
}

std::uint32_t sum_of(std::string_view bytes) {
  boost::crc_32_type sum;
  sum.process_bytes(bytes.data(), bytes.size());
  return sum.checksum();
}

// Reads entry by entry and knows what may follow.
class Reader {
 public:
  Reader(std::string_view bytes, std::string_view file) : bytes_(bytes), file_(file) {}

  Layer head(std::string& scenario) {
    if (bytes_.size() < kHeadBytes) {
      fail(bytes_.size(), fmt::format("the file ends: expected a head of {} bytes", kHeadBytes));
    }
    if (!bytes_.starts_with(kMagic)) fail(0, "no record of accesses: expected HVPRECRD");
    expect_number(8, kVersion, "the format's version");
    const std::uint64_t layer = number_at(bytes_, 12, 4);
    if (layer > static_cast<std::uint64_t>(Layer::kernel)) {
      fail(12, fmt::format("a host {}: expected 0 to 2", layer));
    }
    const std::uint64_t length = number_at(bytes_, 16, 4);
    expect_number(20, 0, "a reserved word");
    if (length + kSumBytes > bytes_.size() - kHeadBytes) {
      fail(16, fmt::format("a scenario of {} bytes: expected at most the {} that follow", length,
                           bytes_.size() - std::min(bytes_.size(), kHeadBytes + kSumBytes)));
    }
    at_ = kHeadBytes + length;
    expect_number(at_, sum_of(bytes_.substr(0, at_)), "the head's checksum");
    scenario = bytes_.substr(kHeadBytes, length);
    at_ += kSumBytes;
    return static_cast<Layer>(layer);
  }

  // The next entry; none at the end, or where the file is cut.
  std::optional<Entry> next() {
    if (at_ == bytes_.size()) return std::nullopt;
    if (ended_) fail(at_, "something behind the record's end: expected nothing");
    const std::size_t left = bytes_.size() - at_;
    if (left < kEntryHeadBytes) return std::nullopt;
    Entry entry = entry_head();
    const std::size_t data = data_bytes(entry);
    if (left < kEntryHeadBytes + data + kSumBytes) return std::nullopt;
    entry.data = {reinterpret_cast<const std::uint8_t*>(bytes_.data()) + at_ + kEntryHeadBytes,
                  data};
    const std::size_t end = at_ + kEntryHeadBytes + data;
    expect_number(end, sum_of(bytes_.substr(at_, end - at_)), "the entry's checksum");
    check(entry);
    at_ = end + kSumBytes;
    return entry;
  }

  std::string cut() const {
    if (ended_) return {};
    if (at_ == bytes_.size()) return fmt::format("byte {}: the record has no end", at_);
    return fmt::format("byte {}: the file ends within an entry", at_);
  }

 private:
  [[noreturn]] void fail(std::size_t at, std::string_view what) const {
    throw InputError(fmt::format("{}: byte {}: {}", file_, at, what));
  }

  void expect_number(std::size_t at, std::uint32_t expected, std::string_view what) const {
    const std::uint64_t found = number_at(bytes_, at, 4);
    if (found != expected) {
      fail(at, fmt::format("{} is {:#x}: expected {:#x}", what, found, expected));
    }
  }

  Entry entry_head() const {
    const std::uint64_t kind = number_at(bytes_, at_, 1);
    if (kind < static_cast<std::uint64_t>(Kind::asked) ||
        kind > static_cast<std::uint64_t>(Kind::fault)) {
      fail(at_, fmt::format("an entry of kind {}: expected 1 to 11", kind));
    }
    if (number_at(bytes_, at_ + 2, 2) != 0) fail(at_ + 2, "a reserved number: expected 0");
    const auto bytes = static_cast<std::uint32_t>(number_at(bytes_, at_ + 4, 4));
    if (bytes > kMostBytes) {
      fail(at_ + 4, fmt::format("{} bytes: expected at most {}", bytes, kMostBytes));
    }
    const std::uint64_t time = number_at(bytes_, at_ + 8, 8);
    if (time > kLatest) fail(at_ + 8, fmt::format("{} ps: expected at most {}", time, kLatest));
    return {.kind = static_cast<Kind>(kind),
            .flags = static_cast<std::uint8_t>(number_at(bytes_, at_ + 1, 1)),
            .time = static_cast<Picoseconds>(time),
            .address = number_at(bytes_, at_ + 16, 8),
            .bytes = bytes,
            .at = at_};
  }

  static std::size_t data_bytes(const Entry& entry) {
    return entry.kind == Kind::asked && !entry.has(kWrite) ? 0 : entry.bytes;
  }

  void check(const Entry& entry) {
    if (entry.time < time_) {
      fail(entry.at + 8, fmt::format("{} ps: expected {} or later", entry.time, time_));
    }
    time_ = entry.time;
    switch (entry.kind) {
      case Kind::asked:
        reads_.push_back(entry.has(kWrite) ? 0 : entry.bytes);
        break;
      case Kind::ended:
        check_end(entry);
        break;
      case Kind::message:
        expect_bytes(entry, 4);
        break;
      case Kind::map:
      case Kind::unmap:
        expect_bytes(entry, 8);
        break;
      case Kind::memory_read:
      case Kind::memory_write:
      case Kind::fault:
        break;
      case Kind::end:
        ended_ = true;
        [[fallthrough]];
      case Kind::line:
      case Kind::missing:
        expect_bytes(entry, 0);
        break;
    }
  }

  void check_end(const Entry& entry) {
    if (next_end_ == reads_.size()) fail(entry.at, "the end of an access: expected one before it");
    if (entry.address != next_end_) {
      fail(entry.at + 16,
           fmt::format("the end of access {}: expected {}", entry.address, next_end_));
    }
    expect_bytes(entry, reads_[next_end_]);
    ++next_end_;
  }

  void expect_bytes(const Entry& entry, std::uint32_t bytes) const {
    if (entry.bytes == bytes) return;
    fail(entry.at + 4, fmt::format("{} bytes: expected {}", entry.bytes, bytes));
  }

  std::string_view bytes_;
  std::string_view file_;
  std::size_t at_ = 0;
  Picoseconds time_ = 0;
  std::vector<std::uint32_t> reads_;  // the bytes of each access that its end has
  std::size_t next_end_ = 0;
  bool ended_ = false;
};

}  // namespace

std::string_view name(Layer layer) {
  switch (layer) {
    case Layer::program:
      return "a program (hvp-board)";
    case Layer::socket:
      return "a client of hvp serve";
    case Layer::kernel:
      return "a kernel (hvp linux)";
  }
  return "";
}

std::uint64_t number_in(const Entry& entry) {
  std::uint64_t number = 0;
  for (std::size_t i = entry.data.size(); i > 0; --i) number = number << 8U | entry.data[i - 1];
  return number;
}

std::string compose_head(Layer layer, std::string_view scenario) {
  std::string bytes(kMagic);
  put(bytes, kVersion, 4);
  put(bytes, static_cast<std::uint32_t>(layer), 4);
  put(bytes, scenario.size(), 4);
  put(bytes, 0, 4);
  bytes += scenario;
  put(bytes, sum_of(bytes), kSumBytes);
  return bytes;
}

std::string compose(const Entry& entry) {
  std::string bytes;
  bytes.reserve(kEntryHeadBytes + entry.data.size() + kSumBytes);
  put(bytes, static_cast<std::uint8_t>(entry.kind), 1);
  put(bytes, entry.flags, 1);
  put(bytes, 0, 2);
  put(bytes, entry.bytes, 4);
  put(bytes, static_cast<std::uint64_t>(entry.time), 8);
  put(bytes, entry.address, 8);
  bytes.append(reinterpret_cast<const char*>(entry.data.data()), entry.data.size());
  put(bytes, sum_of(bytes), kSumBytes);
  return bytes;
}

Record parse_record(std::string bytes, std::string_view file) {
  Record record;
  record.bytes_ = std::make_unique<const std::string>(std::move(bytes));
  Reader reader(*record.bytes_, file);
  record.layer_ = reader.head(record.scenario_);
  while (std::optional<Entry> entry = reader.next()) record.entries_.push_back(*entry);
  record.cut_ = reader.cut();
  return record;
}

Record read_record(const std::filesystem::path& file) {
  const std::string shown = scenario::one_line(file.string());
  std::string bytes;
  try {
    bytes = files::read_regular_file(file, kLargestFile, "a record of accesses");
  } catch (const InputError& e) {
    throw InputError(fmt::format("{}: {}", shown, e.what()));
  }
  return parse_record(std::move(bytes), shown);
}

}  // namespace hvp::record
