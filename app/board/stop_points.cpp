#include "app/board/stop_points.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/scenario/message.h"
#include "models/config/input_error.h"
#include "vp/fpga/register_bank.h"

namespace hvp::app {

namespace {

constexpr std::string_view kWriteTo = "write to ";
constexpr std::string_view kReadOf = "read of ";

struct Place {
  std::uint64_t begin = 0;
  std::uint64_t bytes = 0;
};

std::vector<std::string_view> names() {
  std::vector<std::string_view> all;
  all.reserve(vp::kRegisters.size() + vp::kApertures.size());
  for (const vp::RegisterInfo& info : vp::kRegisters) all.push_back(info.name);
  for (const vp::ApertureInfo& info : vp::kApertures) all.push_back(info.name);
  return all;
}

Place place_of(std::string_view name, std::string_view words) {
  for (const vp::RegisterInfo& info : vp::kRegisters) {
    if (info.name == name) return {info.offset, 4};
  }
  for (const vp::ApertureInfo& info : vp::kApertures) {
    if (info.name == name) return {info.offset, info.size};
  }
  const std::vector<std::string_view> all = names();
  const std::string_view meant = scenario::nearest(name, all);
  if (!meant.empty()) {
    throw InputError(fmt::format("{}: no such register; did you mean {}?", words, meant));
  }
  throw InputError(fmt::format("{}: no such register: expected {}", words,
                               scenario::alternatives({all.begin(), all.end()})));
}

std::optional<std::int64_t> number_behind(std::string_view words, std::string_view kind) {
  if (!words.starts_with(kind)) return std::nullopt;
  words.remove_prefix(kind.size());
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(words.data(), words.data() + words.size(), number);
  if (error != std::errc() || end != words.data() + words.size() || number < 0) return std::nullopt;
  return number;
}

// The register's word of an access that has it.
std::uint32_t word_at(const vp::OutsideHost::Access& access, std::uint64_t offset) {
  std::uint32_t word = 0;
  for (std::uint64_t i = 0; i < 4; ++i) {
    const std::uint64_t at = offset + i - access.offset;
    if (at < access.data.size()) word |= std::uint32_t{access.data[at]} << (8 * i);
  }
  return word;
}

}  // namespace

StopPoints::Point StopPoints::parse(std::string_view words) {
  Point point{.words = std::string(words), .stopped = {}};
  for (const auto& [verb, kind] :
       {std::pair(kWriteTo, Kind::write), std::pair(kReadOf, Kind::read)}) {
    if (!words.starts_with(verb)) continue;
    const Place place = place_of(words.substr(verb.size()), scenario::one_line(words));
    point.kind = kind;
    point.begin = place.begin;
    point.bytes = place.bytes;
    return point;
  }
  for (const auto& [what, kind, first] :
       {std::tuple("interrupt ", Kind::interrupt, 1), std::tuple("message ", Kind::message, 1),
        std::tuple("job ", Kind::job, 0)}) {
    const auto number = number_behind(words, what);
    if (!number || *number < first) continue;
    point.kind = kind;
    point.number = *number;
    return point;
  }
  throw InputError(
      fmt::format("{}: expected \"write to REGISTER\", \"read of REGISTER\", \"interrupt N\" or "
                  "\"message N\" from 1 on, or \"job N\" from 0 on",
                  scenario::in_quotes(words)));
}

// How many of a kind that is counted there were.
std::int64_t StopPoints::told(Kind kind) const {
  vp::OutsideHost& host = board_.host();
  if (kind == Kind::job) return host.frames().jobs();
  return kind == Kind::message ? host.messages() : host.messages() + host.lines();
}

void StopPoints::require_to_come(const Point& point) const {
  if (point.kind == Kind::write || point.kind == Kind::read) return;
  const std::int64_t next = told(point.kind) + (point.kind == Kind::job ? 0 : 1);
  if (point.number >= next) return;
  throw InputError(fmt::format("{}: has been: expected {} or later", point.words, next));
}

void StopPoints::add(std::string_view words, Stopped stopped) {
  Point point = parse(words);
  require_to_come(point);
  point.stopped = std::move(stopped);
  points_.push_back(std::move(point));
}

bool StopPoints::remove(std::string_view words) {
  bool any = false;
  for (Point& point : points_) {
    if (point.removed || point.words != words) continue;
    point.removed = true;
    any = true;
  }
  return any;
}

std::string StopPoints::never_came() const {
  const auto never = std::ranges::find_if(
      points_, [](const Point& point) { return point.came == 0 && !point.removed; });
  return never == points_.end() ? std::string() : never->words;
}

// A host whose access is posted is in it now, and elsewhere when it is made.
void StopPoints::asked(const vp::OutsideHost::Access& access) {
  if (const auto number = board_.host().begins_job(access)) job(*number);
  if (access.command == vp::Command::write) accessed(Kind::write, access);
}

void StopPoints::ended(const vp::OutsideHost::Access& access) {
  if (access.command == vp::Command::read) accessed(Kind::read, access);
}

void StopPoints::message(const vp::ConfigSpace::Message& /*message*/) {
  counted(Kind::message);
  counted(Kind::interrupt);
}

void StopPoints::line(bool up) {
  if (up) counted(Kind::interrupt);
}

void StopPoints::job_began(std::int64_t number) { job(number); }

void StopPoints::job(std::int64_t number) {
  if (number == begun_) return;
  begun_ = number;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Point& point = points_[i];
    if (point.kind != Kind::job || point.number != number) continue;
    tell(point, static_cast<std::uint32_t>(number), 0, "begins");
  }
}

void StopPoints::accessed(Kind kind, const vp::OutsideHost::Access& access) {
  if (access.space != vp::OutsideHost::Space::bar) return;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Point& point = points_[i];
    const bool hit = point.kind == kind && access.offset < point.begin + point.bytes &&
                     point.begin < access.offset + access.data.size();
    if (!hit) continue;
    const std::uint64_t at = std::max(access.offset, point.begin);
    const std::uint32_t word = word_at(access, at);
    tell(point, word, at, fmt::format("0x{:08x}", word));
  }
}

void StopPoints::counted(Kind kind) {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    Point& point = points_[i];
    if (point.kind != kind || point.number != told(kind)) continue;
    tell(point, static_cast<std::uint32_t>(point.number), 0, "arrives");
  }
}

void StopPoints::tell(Point& point, std::uint32_t value, std::uint64_t offset,
                      const std::string& more) {
  if (point.removed) return;
  ++point.came;
  // A job has begun for the host with its first access, which may be under way.
  const std::int64_t job = std::max(begun_, board_.host().frames().jobs() - 1);
  Stop stop{.point = point.words,
            .what = fmt::format("{} {} at {} us, {}", point.words, more,
                                results::microseconds(vp::now_ps()),
                                job < 0 ? "before any job" : fmt::format("in job {}", job)),
            .time = vp::now_ps(),
            .job = job,
            .value = value,
            .offset = offset};
  // It may be removed meanwhile.
  const Stopped stopped = point.stopped;
  stopped(stop);
  // Whoever lets time pass looks at what has come.
  board_.host().come_back();
}

}  // namespace hvp::app
