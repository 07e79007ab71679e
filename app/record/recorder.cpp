#include "app/record/recorder.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <systemc>
#include <vector>

#include <fmt/format.h>

#include "app/results/results_folder.h"
#include "app/scenario/message.h"
#include "models/config/input_error.h"

namespace hvp::record {

namespace fs = std::filesystem;

namespace {

using vp::Command;
using vp::OutsideHost;

template <std::size_t Count>
std::array<std::uint8_t, Count> little_endian(std::uint64_t number) {
  std::array<std::uint8_t, Count> bytes{};
  for (std::size_t i = 0; i < Count; ++i) bytes.at(i) = static_cast<std::uint8_t>(number >> 8 * i);
  return bytes;
}

// Nobody answers a longer access, whatever its length.
std::span<const std::uint8_t> data_of(const OutsideHost::Access& access) {
  return access.data.first(std::min<std::size_t>(access.data.size(), kMostBytes));
}

// A board alone has no body: a file of its surface need not be where the record is replayed.
std::string settings_of(const app::LoadedScenario& loaded) {
  app::Scenario scenario = loaded.scenario;
  if (!scenario.object.mesh.surface.empty()) scenario.object.mesh = {};
  scenario.object.regions.clear();
  return results::resolved_text(scenario, loaded.device_file);
}

fs::path place_for(const fs::path& file, std::string_view option) {
  std::error_code ignored;
  if (file.empty()) throw InputError(fmt::format("{}: expected the name of a file", option));
  if (file.filename().empty() || fs::is_directory(file, ignored)) {
    throw InputError(fmt::format("{} {}: is a folder: expected a file", option,
                                 scenario::one_line(file.string())));
  }
  // It would be replaced.
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored)) {
    throw InputError(fmt::format("{} {}: is there and no regular file: expected a file", option,
                                 scenario::one_line(file.string())));
  }
  // What a link leads to is written, and the link stays.
  if (fs::is_symlink(file, ignored)) {
    std::error_code error;
    if (fs::status(file, error).type() == fs::file_type::none) {
      throw InputError(fmt::format("{} {}: is a link that leads nowhere ({}): expected a file",
                                   option, scenario::one_line(file.string()), error.message()));
    }
    return place_for(file.parent_path() / fs::read_symlink(file), option);
  }
  results::create_folder(file.has_parent_path() ? file.parent_path() : fs::path("."), option);
  return file;
}

}  // namespace

void Recorder::watch(vp::BoardFunction& function) {
  function.host().observe(*this);
  if (vp::HostMemory* const memory = function.memory()) memory->observe(*this);
}

void Recorder::put(Entry entry) {
  entry.time = vp::now_ps();
  if (!entry.data.empty()) entry.bytes = static_cast<std::uint32_t>(entry.data.size());
  sink_(entry);
}

void Recorder::note_fault(std::string_view words) {
  const std::vector<std::uint8_t> data(words.begin(), words.end());
  put({.kind = Kind::fault, .data = data});
}

void Recorder::asked(const OutsideHost::Access& access) {
  Entry entry{.kind = Kind::asked,
              .address = access.offset,
              .bytes = static_cast<std::uint32_t>(data_of(access).size())};
  if (access.space == OutsideHost::Space::configuration) entry.flags |= kConfiguration;
  if (access.space == OutsideHost::Space::message_table) entry.flags |= kTable;
  if (!sc_core::sc_pending_activity_at_current_time()) entry.flags |= kSettled;
  if (access.command == Command::write) {
    entry.flags |= kWrite;
    entry.data = data_of(access);
  }
  put(entry);
}

void Recorder::ended(const OutsideHost::Access& access) {
  Entry entry{.kind = Kind::ended, .address = ends_++};
  if (access.command == Command::read) entry.data = data_of(access);
  put(entry);
}

void Recorder::message(const vp::ConfigSpace::Message& message) {
  ++interrupts_;
  const auto data = little_endian<4>(message.data);
  put({.kind = Kind::message, .address = message.address, .data = data});
}

void Recorder::line(bool up) {
  ++interrupts_;
  put({.kind = Kind::line, .flags = up ? kUp : std::uint8_t{0}});
}

void Recorder::put_range(Kind kind, std::uint8_t flags, std::uint64_t address,
                         std::uint64_t bytes) {
  const auto data = little_endian<8>(bytes);
  put({.kind = kind, .flags = flags, .address = address, .data = data});
}

void Recorder::mapped(std::uint64_t address, std::uint64_t bytes, bool writable) {
  put_range(Kind::map, writable ? kWritable : std::uint8_t{0}, address, bytes);
}

void Recorder::unmapped(std::uint64_t address, std::uint64_t bytes) {
  put_range(Kind::unmap, 0, address, bytes);
}

void Recorder::moved(bool read, std::uint64_t address, std::span<const std::uint8_t> data,
                     bool answered) {
  put({.kind = read ? Kind::memory_read : Kind::memory_write,
       .flags = answered ? kAnswered : std::uint8_t{0},
       .address = address,
       .data = data});
}

RecordFile::RecordFile(const fs::path& file, std::string_view option, Layer layer,
                       const app::LoadedScenario& scenario)
    : stream_(place_for(file, option)), recorder_([this](const Entry& entry) {
        stream_.write(compose(entry));
        // What the host has seen is on the disk before it goes on.
        if (entry.kind == Kind::ended || entry.kind == Kind::message || entry.kind == Kind::line) {
          stream_.flush();
        }
      }) {
  stream_.write(compose_head(layer, settings_of(scenario)));
  stream_.flush();
}

void RecordFile::finish() {
  recorder_.note_end();
  stream_.finish();
}

}  // namespace hvp::record
