#include "app/linux/guest_process.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/linux/guest_error.h"
#include "app/results/part_files.h"

namespace hvp::guest {

namespace {

// Waits are split into pieces of this length, between which an interruption is noticed.
constexpr std::chrono::milliseconds kLongestWait{200};
// The time that a kernel has to end after its last message.
constexpr std::chrono::seconds kTimeToEnd{3};
// Longer lines without a line break are split.
constexpr std::size_t kLongestLine = 4096;
constexpr std::string_view kPanic = "Kernel panic - not syncing: ";

}  // namespace

GuestProcess::GuestProcess(const Settings& settings)
    : patience_(settings.patience),
      print_(settings.print),
      program_(settings.kernel, settings.arguments,
               {.environment = {},
                .own_group = true,
                .hold = settings.hold,
                // The kernel's memory layout depends on the addresses of its program.
                .same_addresses = true}),
      consoles_{{program_.output(), {}}, {program_.errors(), {}}} {
  start_keeper(settings.folder);
}

GuestProcess::~GuestProcess() {
  kill(-program_.process(), SIGKILL);
  alive_.reset();
  int ignored = 0;
  while (waitpid(keeper_, &ignored, 0) < 0 && errno == EINTR) {
  }
}

// Starts the keeper. The kernel's processes are processes of this machine that it traces; they
// continue without it, and the keeper ends them if this program cannot.
void GuestProcess::start_keeper(const std::filesystem::path& folder) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot make a pipe");
  }
  Descriptor watched(ends[0]);
  alive_ = Descriptor(ends[1]);
  const pid_t guest = program_.process();
  keeper_ = fork();
  if (keeper_ < 0) throw std::system_error(errno, std::generic_category(), "cannot fork");
  if (keeper_ > 0) return;
  // Signals that a terminal sends to all of its programs must not end the keeper.
  setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
  close_range(0, static_cast<unsigned>(watched.number()) - 1, 0);
  close_range(static_cast<unsigned>(watched.number()) + 1, ~0U, 0);
  char byte = 0;
  while (read(watched.number(), &byte, 1) < 0 && errno == EINTR) {
  }
  kill(-guest, SIGKILL);
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  _exit(0);
}

void GuestProcess::print(Console& console) {
  if (!panic_) {
    if (const auto at = console.line.find(kPanic); at != std::string::npos) {
      panic_ = console.line.substr(at + kPanic.size());
    }
  }
  while (!console.line.empty() && console.line.back() == '\r') console.line.pop_back();
  if (print_) print_(console.line);
  console.line.clear();
}

void GuestProcess::relay(Console& console) {
  std::array<char, 4096> buffer{};
  const ssize_t count = read(console.descriptor, buffer.data(), buffer.size());
  if (count < 0 && errno == EINTR) return;
  if (count <= 0) {
    console.open = false;
    if (!console.line.empty()) print(console);
    return;
  }
  for (const char character : std::string_view(buffer.data(), static_cast<std::size_t>(count))) {
    if (character != '\n') console.line.push_back(character);
    if (character == '\n' || console.line.size() >= kLongestLine) print(console);
  }
}

std::size_t GuestProcess::wait_readable(std::span<const int> descriptors) {
  std::vector<pollfd> sources;
  for (;;) {
    if (results::interrupted() != 0) throw GuestInterrupted();
    if (patience_ && Clock::now() - heard_at_ > *patience_) {
      throw GuestHung(fmt::format("nothing was heard of the guest for {} s",
                                  std::chrono::duration<double>(*patience_).count()));
    }
    sources.clear();
    for (const int number : descriptors) sources.push_back({number, POLLIN, 0});
    for (const Console& console : consoles_) {
      sources.push_back({console.open ? console.descriptor : -1, POLLIN, 0});
    }
    const int ready = poll(sources.data(), sources.size(), static_cast<int>(kLongestWait.count()));
    if (ready < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "cannot wait for the guest");
    }
    if (ready <= 0) continue;
    for (std::size_t i = 0; i < consoles_.size(); ++i) {
      if (sources[descriptors.size() + i].revents == 0) continue;
      relay(consoles_[i]);
      did_something();
    }
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      if (sources[i].revents != 0) return i;
    }
    if (!consoles_[0].open && !consoles_[1].open) throw GuestGone();
  }
}

std::optional<int> GuestProcess::wait_for_end() {
  const auto deadline = Clock::now() + kTimeToEnd;
  while ((consoles_[0].open || consoles_[1].open) && Clock::now() < deadline) {
    std::array<pollfd, 2> sources{};
    for (std::size_t i = 0; i < 2; ++i) {
      sources[i] = {consoles_[i].open ? consoles_[i].descriptor : -1, POLLIN, 0};
    }
    if (poll(sources.data(), 2, static_cast<int>(kLongestWait.count())) <= 0) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      if (sources[i].revents != 0) relay(consoles_[i]);
    }
  }
  const results::LaunchedProgram::Result result = program_.wait(kTimeToEnd);
  if (result.timed_out) return std::nullopt;
  return result.exit_status;
}

}  // namespace hvp::guest
