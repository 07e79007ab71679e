#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace hvp::results {

// A child process, run without a shell. It dies with its parent and leaves no core file; its
// standard input is empty and its output is kept. The destructor ends and reaps the child.
class LaunchedProgram {
 public:
  struct Options {
    std::vector<std::pair<std::string, std::string>> environment;  // set on top of the parent's
    bool report_pipe = false;  // the program may write to descriptor kReportDescriptor
    // The program leads a process group: its own children end with it.
    bool own_group = false;
    // The program is stopped before its first instruction, until a debugger continues it.
    bool hold = false;
    // The program's addresses are the same in each run.
    bool same_addresses = false;
  };
  static constexpr int kReportDescriptor = 3;

  // Throws std::system_error when the system has no process or pipe left. A program that cannot
  // be executed exits with status 127.
  LaunchedProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                  const Options& options);
  ~LaunchedProgram();
  LaunchedProgram(const LaunchedProgram&) = delete;
  LaunchedProgram& operator=(const LaunchedProgram&) = delete;

  struct Result {
    int exit_status = -1;  // -1: ended by a signal or by the time limit
    int signal = 0;
    bool timed_out = false;
    bool interrupted = false;  // ended, because hvp itself was interrupted
    std::string output;        // the first 64 KiB of standard output
    std::string errors;        // the first 64 KiB of standard error
  };
  // Waits until the program ends, and kills it after the limit.
  Result wait(std::chrono::milliseconds limit);

  // The descriptors of its output, for a caller that reads while it runs, in place of wait(); and
  // its process number.
  int output() const { return output_; }
  int errors() const { return errors_; }
  pid_t process() const { return started_; }

  // The first line that the program writes to the report descriptor; absent when it ends or the
  // limit passes before.
  std::optional<std::string> report_line(std::chrono::milliseconds limit);

 private:
  void send(int signal) const;
  void hold_at_start() const;
  void reap_or_kill(std::chrono::steady_clock::time_point deadline, Result& result);

  pid_t pid_ = -1;  // −1 once it was reaped
  pid_t started_ = -1;
  bool own_group_;
  int output_ = -1;
  int errors_ = -1;
  int report_ = -1;
};

}  // namespace hvp::results
