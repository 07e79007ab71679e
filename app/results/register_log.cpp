#include "app/results/register_log.h"

#include <cstring>

#include <fmt/format.h>

#include "app/results/number_text.h"

namespace hvp::results {

RegisterLog::RegisterLog(const std::filesystem::path& path) : stream_(path) {
  stream_.write("# time_us access register bytes first_word outcome\n");
}

void RegisterLog::access(vp::Picoseconds time, vp::Command command, const vp::RegisterBank& bank,
                         const vp::AccessResult& outcome, std::uint64_t offset,
                         std::span<const std::uint8_t> data) {
  std::uint32_t word = 0;
  std::memcpy(&word, data.data(), std::min(data.size(), sizeof(word)));
  stream_.write(fmt::format("{} {} {} {} {:#010x} {}\n", microseconds(time),
                            command == vp::Command::read ? "read" : "write", bank.name_at(offset),
                            data.size(), word, vp::name(outcome.access)));
}

}  // namespace hvp::results
