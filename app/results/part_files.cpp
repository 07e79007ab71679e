#include "app/results/part_files.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <ios>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace hvp::results {

namespace {

// A run has frames.csv, trace.json, registers.log, engine.vcd,
// engine-port.txt, and one file that is written at
// once.
constexpr std::size_t kMost = 16;
std::array<std::atomic<const char*>, kMost> names{};
static_assert(std::atomic<const char*>::is_always_lock_free, "a signal handler must not wait");

std::size_t enter(const char* name) {
  for (std::size_t slot = 0; slot < kMost; ++slot) {
    const char* none = nullptr;
    if (names[slot].compare_exchange_strong(none, name)) return slot;
  }
  throw std::logic_error("more files are written at once than were thought of");
}

}  // namespace

UnfinishedFile::UnfinishedFile(const std::filesystem::path& path)
    : path_(path), slot_(enter(path_.c_str())) {}

UnfinishedFile::~UnfinishedFile() { names[slot_].store(nullptr); }

void UnfinishedFile::remove_all() noexcept {
  for (const auto& entry : names) {
    if (const char* name = entry.load()) ::unlink(name);
  }
}

std::filesystem::path part_of(const std::filesystem::path& path) {
  std::error_code none;
  const std::filesystem::file_status there = std::filesystem::status(path, none);
  // The whole file takes the place of what has its name, and must not take a device's.
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there)) {
    throw std::runtime_error(
        fmt::format("cannot write {}: it is there and no regular file", path.string()));
  }
  std::filesystem::path part = path;
  part += ".part";
  // Removes a file of that name, so that no pipe and no link to elsewhere is written into.
  std::error_code ignored;
  std::filesystem::remove(part, ignored);
  return part;
}

void write_through_part_file(const std::filesystem::path& path, std::string_view bytes) {
  const UnfinishedFile unfinished(part_of(path));
  const std::filesystem::path& part = unfinished.path();
  errno = 0;
  std::ofstream file(part, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  std::error_code error;
  if (!file) {
    const int cause = errno;
    std::filesystem::remove(part, error);
    throw std::runtime_error(
        fmt::format("cannot write {}: {}", path.string(),
                    cause != 0 ? std::generic_category().message(cause) : "write failed"));
  }
  std::filesystem::rename(part, path, error);
  if (error) {
    const std::string cause = error.message();
    std::filesystem::remove(part, error);
    throw std::runtime_error(fmt::format("cannot write {}: {}", path.string(), cause));
  }
}

PartStream::PartStream(std::filesystem::path path) : path_(std::move(path)), part_(part_of(path_)) {
  stream_.open(part_.path(), std::ios::binary | std::ios::trunc);
  if (!stream_) throw std::runtime_error("cannot write " + part_.path().string());
}

PartStream::~PartStream() {
  if (finished_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(part_.path(), ignored);
}

void PartStream::write(std::string_view text) {
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
}

void PartStream::overwrite(std::size_t at, std::string_view text) {
  stream_.seekp(static_cast<std::streamoff>(at));
  write(text);
  stream_.seekp(0, std::ios::end);
}

void PartStream::finish() {
  stream_.close();
  if (!stream_)
    throw std::runtime_error("cannot write " + part_.path().string() + ": is the disk full?");
  std::filesystem::rename(part_.path(), path_);
  finished_ = true;
}

namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t deferred = 0;
volatile std::sig_atomic_t noted = 0;
volatile std::sig_atomic_t on_terminal = 0;

// Calls only what POSIX allows in a signal handler (signal-safety(7)).
void say(std::string_view text) {
  const ssize_t ignored = ::write(STDERR_FILENO, text.data(), text.size());
  static_cast<void>(ignored);
}

// Takes effect when the handler returns, or at once where there is none.
void raise_by_default(int number) {
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  ::sigaction(number, &action, nullptr);
  ::raise(number);
}

extern "C" void take_signal(int number) {
  if (deferred != 0 && noted == 0) {
    noted = number;
    return;
  }
  UnfinishedFile::remove_all();
  if (on_terminal != 0) say("\r\033[K");
  say("hvp: interrupted\n");
  raise_by_default(number);
}

}  // namespace

void end_cleanly_when_interrupted() {
  on_terminal = ::isatty(STDERR_FILENO);
  for (const int number : kSignals) {
    struct sigaction before {};
    if (::sigaction(number, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
    struct sigaction action {};
    action.sa_handler = take_signal;
    // Signals are handled one after the other: the second must find the note of the first.
    for (const int other : kSignals) ::sigaddset(&action.sa_mask, other);
    ::sigaction(number, &action, nullptr);
  }
}

DeferredInterruption::DeferredInterruption() {
  noted = 0;
  deferred = 1;
}

DeferredInterruption::~DeferredInterruption() { deferred = 0; }

int interrupted() { return noted; }

void end_as_interrupted() {
  UnfinishedFile::remove_all();
  raise_by_default(noted);
  std::_Exit(128 + noted);
}

}  // namespace hvp::results
