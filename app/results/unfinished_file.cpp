#include "app/results/unfinished_file.h"

#include <array>
#include <atomic>
#include <stdexcept>

#include <unistd.h>

namespace hvp::results {
namespace {

// Of one run: frames.csv, trace.json, registers.log, engine.vcd, and one that is written at once.
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

}  // namespace hvp::results
