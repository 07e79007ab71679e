#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/time/picoseconds.h"

// The file in which everything is recorded that passes between a host outside the simulation and
// the board's PCI function (docs/replay.md). Without SystemC.
namespace hvp::record {

// The host that was recorded.
enum class Layer : std::uint32_t {
  program,  // of the C library hvp-board
  socket,   // the client of hvp serve
  kernel,   // of hvp linux
};
std::string_view name(Layer layer);

enum class Kind : std::uint8_t {
  asked = 1,         // the host queues an access
  ended = 2,         // the oldest access that had not ended has
  message = 3,       // the host is told of a message
  line = 4,          // INTA# went up or down for the host
  memory_read = 5,   // by the board
  memory_write = 6,  // by the board
  map = 7,           // the host gives the board a range of its memory
  unmap = 8,
  missing = 9,  // of a replay: an interrupt was awaited in vain
  end = 10,     // of the record
  fault = 11,   // the program asks for one, in the words of [[fault]]
};

// What the one number of flags says, by kind.
inline constexpr std::uint8_t kWrite = 1;          // asked: else a read
inline constexpr std::uint8_t kConfiguration = 2;  // asked: else the BAR
inline constexpr std::uint8_t kTable = 8;          // asked: else not the table of MSI-X
inline constexpr std::uint8_t kSettled = 4;        // asked: nothing was left to do at that time
inline constexpr std::uint8_t kUp = 1;             // line
inline constexpr std::uint8_t kAnswered = 1;       // memory_read, memory_write: else refused
inline constexpr std::uint8_t kWritable = 1;       // map

// The most bytes of an access: more than the BAR has, so that nobody answers a longer one.
inline constexpr std::uint32_t kMostBytes = std::uint32_t{1} << 26U;

struct Entry {
  Kind kind = Kind::end;
  std::uint8_t flags = 0;
  Picoseconds time = 0;       // simulated
  std::uint64_t address = 0;  // asked: in its space; ended: the access' number; else of the bus
  std::uint32_t bytes = 0;    // of the access; of a range as `data`, eight bytes
  std::span<const std::uint8_t> data = {};
  std::size_t at = 0;  // where it begins in the file

  bool has(std::uint8_t flag) const { return (flags & flag) != 0; }
};

// An entry's number of bytes in `data`, as a little-endian number; at most eight.
std::uint64_t number_in(const Entry& entry);

// A record that was read and checked: times do not go back; each access ends once, in order, and a
// read with as many bytes as were asked for.
class Record {
 public:
  Layer layer() const { return layer_; }
  // Every setting of the recorded scenario, as `hvp resolve` prints them.
  const std::string& scenario() const { return scenario_; }
  const std::vector<Entry>& entries() const { return entries_; }
  // Why it has no end: the recording was killed, or the file was cut. Empty for a whole one.
  const std::string& cut() const { return cut_; }
  // The time of the last entry.
  Picoseconds last() const { return entries_.empty() ? 0 : entries_.back().time; }

 private:
  friend Record parse_record(std::string bytes, std::string_view file);

  Layer layer_ = Layer::program;
  std::string scenario_;
  std::unique_ptr<const std::string> bytes_;  // of which the entries are parts
  std::vector<Entry> entries_;
  std::string cut_;
};

std::string compose_head(Layer layer, std::string_view scenario);
std::string compose(const Entry& entry);

// Reads what is whole. Throws InputError, one line with `file`, the byte and what was expected
// there, for what is no record; one that is cut behind its head is read up to the cut.
Record parse_record(std::string bytes, std::string_view file);
// The same of a regular file of at most 1 GiB.
Record read_record(const std::filesystem::path& file);

}  // namespace hvp::record
