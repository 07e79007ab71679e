#pragma once

// A record of every kind of entry, made by hand.
#include <array>
#include <cstdint>
#include <string>

#include "app/record/record.h"

namespace hvp::record::test {

inline constexpr std::array<std::uint8_t, 4> kOne = {1, 0, 0, 0};
inline constexpr std::array<std::uint8_t, 4> kTwo = {2, 0, 0, 0};
inline constexpr std::array<std::uint8_t, 8> kPage = {0, 16, 0, 0, 0, 0, 0, 0};

inline std::string head() { return compose_head(Layer::socket, "title = \"a\"\n"); }

// A read of `word` at an offset, asked for and answered at these times.
inline std::string read_of(std::uint64_t number, std::uint64_t offset, Picoseconds asked,
                           Picoseconds ended, std::span<const std::uint8_t> word) {
  return compose({.kind = Kind::asked, .time = asked, .address = offset, .bytes = 4}) +
         compose({.kind = Kind::ended, .time = ended, .address = number, .bytes = 4, .data = word});
}

inline std::string message(Picoseconds time) {
  return compose(
      {.kind = Kind::message, .time = time, .address = 0xfee0'0000, .bytes = 4, .data = kOne});
}

inline std::string moved(Kind kind, Picoseconds time, std::span<const std::uint8_t> word) {
  return compose({.kind = kind,
                  .flags = kAnswered,
                  .time = time,
                  .address = 0x1000,
                  .bytes = 4,
                  .data = word});
}

inline std::string end(Picoseconds time) { return compose({.kind = Kind::end, .time = time}); }

inline std::string sample() {
  return head() +
         compose({.kind = Kind::map,
                  .flags = kWritable,
                  .time = 0,
                  .address = 0x1000,
                  .bytes = 8,
                  .data = kPage}) +
         read_of(0, 0x24, 10, 20, kOne) +
         compose({.kind = Kind::asked,
                  .flags = kWrite | kSettled,
                  .time = 30,
                  .address = 0x20,
                  .bytes = 4,
                  .data = kTwo}) +
         compose({.kind = Kind::ended, .time = 40, .address = 1}) +
         moved(Kind::memory_read, 50, kOne) + moved(Kind::memory_write, 60, kTwo) + message(70) +
         compose({.kind = Kind::line, .flags = kUp, .time = 80}) +
         compose({.kind = Kind::unmap, .time = 90, .address = 0x1000, .bytes = 8, .data = kPage}) +
         end(100);
}

}  // namespace hvp::record::test
