#include "app/results/launched_program.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/personality.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/results/part_files.h"

extern char** environ;

namespace hvp::results {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kKept = 65536;

struct Pipe {
  int read_end = -1;
  int write_end = -1;

  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
      throw std::system_error(errno, std::generic_category(), "cannot make a pipe");
    read_end = ends[0];
    write_end = ends[1];
  }
  ~Pipe() {
    if (read_end >= 0) close(read_end);
    if (write_end >= 0) close(write_end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int take_read_end() { return std::exchange(read_end, -1); }
};

// In pieces, between which an interruption is noticed.
constexpr std::int64_t kLongestWait = 200;  // ms

int milliseconds_until(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  return static_cast<int>(std::clamp<std::int64_t>(left, 0, kLongestWait));
}

// The time in which a program that is told to end may clean up.
constexpr auto kTimeToEnd = std::chrono::seconds(3);

// The parent's environment with some variables set anew.
std::vector<std::string> environment_with(
    const std::vector<std::pair<std::string, std::string>>& changes) {
  std::vector<std::string> out;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const bool changed = std::any_of(changes.begin(), changes.end(), [&](const auto& change) {
      return text.starts_with(change.first) && text.substr(change.first.size()).starts_with('=');
    });
    if (!changed) out.emplace_back(text);
  }
  for (const auto& [name, value] : changes) out.emplace_back(name).append("=").append(value);
  return out;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> out;
  out.reserve(texts.size() + 1);
  for (std::string& text : texts) out.push_back(text.data());
  out.push_back(nullptr);
  return out;
}

// Reads what there is; false at the end of the stream.
bool drain(int descriptor, std::string& kept) {
  std::array<char, 4096> buffer{};
  const ssize_t count = read(descriptor, buffer.data(), buffer.size());
  if (count < 0) return errno == EINTR;
  if (count == 0) return false;
  const std::size_t room = kKept - std::min(kept.size(), kKept);
  kept.append(buffer.data(), std::min(room, static_cast<std::size_t>(count)));
  return true;
}

// Calls only functions that are safe in a signal handler: at the fork another thread may have owned
// any lock.
[[noreturn]] void become(const char* program, char* const* arguments, char* const* environment,
                         int output, int errors, int report,
                         const LaunchedProgram::Options& options, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);
  if (options.own_group) setpgid(0, 0);
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  dup2(errors, STDERR_FILENO);
  if (report == LaunchedProgram::kReportDescriptor)
    fcntl(report, F_SETFD, 0);
  else if (report >= 0)
    dup2(report, LaunchedProgram::kReportDescriptor);
  if (options.same_addresses) personality(ADDR_NO_RANDOMIZE);
  if (options.hold) {
    // Lets any debugger trace the program, also where only its parent may.
    prctl(PR_SET_PTRACER, PR_SET_PTRACER_ANY);
    ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
  }
  execve(program, arguments, environment);
  _exit(127);
}

}  // namespace

LaunchedProgram::LaunchedProgram(const std::filesystem::path& program,
                                 const std::vector<std::string>& arguments, const Options& options)
    : own_group_(options.own_group) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<std::string> variables = environment_with(options.environment);
  const std::vector<char*> argv = pointers_to(words);
  const std::vector<char*> envp = pointers_to(variables);
  Pipe output;
  Pipe errors;
  Pipe report;
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) throw std::system_error(errno, std::generic_category(), "cannot fork");
  if (pid_ == 0)
    become(words[0].c_str(), argv.data(), envp.data(), output.write_end, errors.write_end,
           options.report_pipe ? report.write_end : -1, options, parent);
  started_ = pid_;
  // Whoever of the two is first: its group is there when the constructor returns.
  if (options.own_group) setpgid(pid_, pid_);
  output_ = output.take_read_end();
  errors_ = errors.take_read_end();
  report_ = report.take_read_end();
  if (options.hold) hold_at_start();
}

// A traced program stops when it has become itself; from then on it is a stopped one, not a traced
// one. One that could not be executed has ended, which whoever waits for it sees.
void LaunchedProgram::hold_at_start() const {
  siginfo_t change{};
  while (waitid(P_PID, static_cast<id_t>(pid_), &change, WSTOPPED | WEXITED | WNOWAIT) < 0 &&
         errno == EINTR) {
  }
  if (change.si_code == CLD_TRAPPED || change.si_code == CLD_STOPPED) {
    ptrace(PTRACE_DETACH, pid_, nullptr, SIGSTOP);
  }
}

LaunchedProgram::~LaunchedProgram() {
  if (pid_ > 0) {
    send(SIGTERM);
    Result ignored;
    reap_or_kill(Clock::now() + kTimeToEnd, ignored);
  }
  close(output_);
  close(errors_);
  close(report_);
}

void LaunchedProgram::send(int signal) const { kill(own_group_ ? -pid_ : pid_, signal); }

void LaunchedProgram::reap_or_kill(Clock::time_point deadline, Result& result) {
  int status = 0;
  for (;;) {
    const pid_t reaped = waitpid(pid_, &status, WNOHANG);
    if (reaped == pid_) break;
    if (reaped < 0 && errno != EINTR) {  // somebody else reaped it: its status is lost
      pid_ = -1;
      return;
    }
    if (Clock::now() >= deadline) {
      result.timed_out = true;
      send(SIGKILL);
      while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
      }
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  pid_ = -1;
  if (result.timed_out) return;
  if (WIFEXITED(status)) result.exit_status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
}

LaunchedProgram::Result LaunchedProgram::wait(std::chrono::milliseconds limit) {
  const Clock::time_point deadline = Clock::now() + limit;
  Result result;
  bool output_open = true;
  bool errors_open = true;
  while ((output_open || errors_open) && Clock::now() < deadline) {
    if (interrupted() != 0) {
      result.interrupted = true;
      send(SIGTERM);
      reap_or_kill(Clock::now() + kTimeToEnd, result);
      return result;
    }
    pollfd streams[2] = {{output_open ? output_ : -1, POLLIN, 0},
                         {errors_open ? errors_ : -1, POLLIN, 0}};
    if (poll(streams, 2, milliseconds_until(deadline)) <= 0) continue;
    if (streams[0].revents != 0) output_open = drain(output_, result.output);
    if (streams[1].revents != 0) errors_open = drain(errors_, result.errors);
  }
  reap_or_kill(deadline, result);
  return result;
}

std::optional<std::string> LaunchedProgram::report_line(std::chrono::milliseconds limit) {
  const Clock::time_point deadline = Clock::now() + limit;
  std::string text;
  while (Clock::now() < deadline && interrupted() == 0) {
    pollfd stream = {report_, POLLIN, 0};
    if (poll(&stream, 1, milliseconds_until(deadline)) <= 0) continue;
    if (!drain(report_, text)) return std::nullopt;
    if (const auto end = text.find('\n'); end != std::string::npos) return text.substr(0, end);
  }
  return std::nullopt;
}

}  // namespace hvp::results
