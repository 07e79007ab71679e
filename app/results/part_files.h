#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string_view>

// Result files that are being written, and the signals that interrupt the program: a signal that
// ends the program removes the unfinished files.

namespace hvp::results {

// The registered name of a file that is being written. It is registered before the file is created
// and until the file has its final name or is removed; a signal that ends the program removes the
// file.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::filesystem::path& path);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Removes all registered files. A signal handler may call it.
  static void remove_all() noexcept;

 private:
  std::filesystem::path path_;
  std::size_t slot_;
};

// Returns "<path>.part", the name of a file until it is whole, and removes a file that has that
// name already. Throws std::runtime_error if something else than a file has the final name: a
// folder or a device.
std::filesystem::path part_of(const std::filesystem::path& path);

// Writes `bytes` to "<path>.part" and renames that to `path`, so that a run that is killed or a
// disk that is full leaves no half file under the final name. Throws std::runtime_error naming
// the file and the cause, after removing the part file.
void write_through_part_file(const std::filesystem::path& path, std::string_view bytes);

// A result file that grows during the run. It is written as "<path>.part", which finish() renames;
// the destructor removes a file that was not finished.
class PartStream {
 public:
  // Throws std::runtime_error where the file cannot be created.
  explicit PartStream(std::filesystem::path path);
  ~PartStream();
  PartStream(const PartStream&) = delete;
  PartStream& operator=(const PartStream&) = delete;

  void write(std::string_view text);
  // Replaces what was written from byte `at` on.
  void overwrite(std::size_t at, std::string_view text);
  // Hands what was written to the operating system, so that a part file has it if this process is
  // killed.
  void flush() { stream_.flush(); }
  // Throws std::runtime_error where the disk did not take all of it.
  void finish();

 private:
  std::filesystem::path path_;
  UnfinishedFile part_;
  std::ofstream stream_;
  bool finished_ = false;
};

// After this call SIGINT (Ctrl-C), SIGHUP (the terminal was closed) and SIGTERM remove the
// unfinished files and end the program with the same signal, so that the shell sees which one it
// was. A signal that the program's parent ignores stays ignored.
void end_cleanly_when_interrupted();

// While an object of this class exists, the first signal is only noted: the work at hand ends early
// and keeps what was done. The second signal ends the program at once.
class DeferredInterruption {
 public:
  DeferredInterruption();
  ~DeferredInterruption();
  DeferredInterruption(const DeferredInterruption&) = delete;
  DeferredInterruption& operator=(const DeferredInterruption&) = delete;
};

// The signal that was noted; 0 without one.
int interrupted();

// Ends the program with the signal that was noted. The caller flushes its files first.
[[noreturn]] void end_as_interrupted();

}  // namespace hvp::results
