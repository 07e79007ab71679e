#include "app/process/sandbox.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "models/config/input_error.h"

#if defined(__SANITIZE_ADDRESS__)
#define HVP_ADDRESS_SPACE_IS_RESERVED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer) || \
    __has_feature(thread_sanitizer)
#define HVP_ADDRESS_SPACE_IS_RESERVED 1
#endif
#endif

namespace hvp::app {

namespace {

// A message through the pipe: one byte for its kind, eight for its length,
// then the text. Both ends are the same program, so the byte order is its own.
enum class Message : char {
  progress = 'p',
  refusal_key = 'k',
  refusal = 'r',
  failure = 'f',
  result = 'd'
};

// The child may sleep or wait where CPU time does not pass; the patience of the parent is this
// many times the CPU limit.
constexpr int kPatience = 4;

void write_all(int fd, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::write(fd, data, size);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) ::_exit(2);  // the parent is gone
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

void send(int fd, Message kind, std::string_view text) {
  const char code = static_cast<char>(kind);
  const std::uint64_t size = text.size();
  std::array<char, sizeof size> length{};
  std::memcpy(length.data(), &size, sizeof size);
  write_all(fd, &code, 1);
  write_all(fd, length.data(), length.size());
  write_all(fd, text.data(), text.size());
}

void limit(int resource, rlim_t soft, rlim_t hard) {
  const rlimit value{soft, hard};
  ::setrlimit(static_cast<__rlimit_resource>(resource), &value);
}

[[noreturn]] void run_child(int fd, pid_t parent, const SandboxLimits& limits,
                            const std::function<std::string(const Progress&)>& work) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(2);  // it ended before that
  for (const int sig : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU}) {
    std::signal(sig, SIG_DFL);
  }
  std::signal(SIGPIPE, SIG_IGN);
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  if (null >= 0) {
    for (int standard = 0; standard < 3; ++standard) ::dup2(null, standard);
  }
  limit(RLIMIT_CORE, 0, 0);
  const auto seconds = static_cast<rlim_t>(limits.cpu_seconds);
  limit(RLIMIT_CPU, seconds, seconds + 1);
#ifndef HVP_ADDRESS_SPACE_IS_RESERVED
  limit(RLIMIT_AS, limits.memory_bytes, limits.memory_bytes);
#endif
  try {
    const Progress progress = [fd](std::string_view text) { send(fd, Message::progress, text); };
    const std::string result = work(progress);
    send(fd, Message::result, result);
  } catch (const InputError& error) {
    send(fd, Message::refusal_key, error.key());
    send(fd, Message::refusal, error.what());
  } catch (const std::bad_alloc&) {
    send(fd, Message::failure, "ran out of memory");
  } catch (const std::exception& error) {
    send(fd, Message::failure, error.what());
  } catch (...) {
    send(fd, Message::failure, "threw something that is not an exception");
  }
  ::_exit(0);  // neither the parent's exit handlers nor its buffers are the child's to flush
}

class Child {
 public:
  Child(pid_t pid, int fd) : pid_(pid), fd_(fd) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (fd_ >= 0) ::close(fd_);
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      wait();
    }
  }

  // False where nothing came within the time or the child closed its end.
  bool read_all(char* data, std::size_t size, int timeout_ms) {
    while (size > 0) {
      pollfd ready{fd_, POLLIN, 0};
      const int count = ::poll(&ready, 1, timeout_ms);
      if (count < 0 && errno == EINTR) continue;
      if (count == 0) timed_out_ = true;
      if (count <= 0) return false;
      const ssize_t got = ::read(fd_, data, size);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      data += got;
      size -= static_cast<std::size_t>(got);
    }
    return true;
  }

  // The child's end, as a sentence without a subject.
  std::string ending(const SandboxLimits& limits) {
    if (timed_out_) {
      return fmt::format("gave no answer within {} s", kPatience * limits.cpu_seconds);
    }
    const int status = wait();
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL)) {
      return fmt::format("did not end within {} s of CPU time", limits.cpu_seconds);
    }
    if (WIFSIGNALED(status)) {
      return fmt::format("crashed (signal {}, {})", WTERMSIG(status),
                         ::strsignal(WTERMSIG(status)));
    }
    return fmt::format("ended without a result (exit status {})", WEXITSTATUS(status));
  }

 private:
  int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

  pid_t pid_;
  int fd_;
  bool timed_out_ = false;
};

}  // namespace

std::string run_in_sandbox(std::string_view task, const std::string& key,
                           const SandboxLimits& limits, const Progress& progress,
                           const std::function<std::string(const Progress&)>& work) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) {
    throw std::runtime_error(fmt::format("no pipe for {}: {}", task, std::strerror(errno)));
  }
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) {
    const int reason = errno;
    ::close(pipe[0]);
    ::close(pipe[1]);
    throw std::runtime_error(fmt::format("no process for {}: {}", task, std::strerror(reason)));
  }
  if (pid == 0) {
    ::close(pipe[0]);
    run_child(pipe[1], parent, limits, work);
  }
  ::close(pipe[1]);
  Child child(pid, pipe[0]);
  const int timeout_ms = 1000 * kPatience * limits.cpu_seconds;

  std::string refusal_key;
  while (true) {
    char code = 0;
    std::uint64_t size = 0;
    std::array<char, sizeof size> length{};
    std::string text;
    bool complete = child.read_all(&code, 1, timeout_ms) &&
                    child.read_all(length.data(), length.size(), timeout_ms);
    if (complete) {
      std::memcpy(&size, length.data(), sizeof size);
      text.resize(size);
      complete = child.read_all(text.data(), text.size(), timeout_ms);
    }
    if (!complete) throw InputError(key, fmt::format("{} {}", task, child.ending(limits)));
    switch (static_cast<Message>(code)) {
      case Message::progress:
        if (progress) progress(text);
        break;
      case Message::refusal_key:
        refusal_key = text;
        break;
      case Message::refusal:
        throw InputError(refusal_key, text);
      case Message::failure:
        throw InputError(key, fmt::format("{} failed: {}", task, text));
      case Message::result:
        return text;
    }
  }
}

}  // namespace hvp::app
