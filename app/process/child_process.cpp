#include "app/process/child_process.h"

#include <array>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "models/config/input_error.h"

namespace hvp::app {

namespace {

using nlohmann::json;

std::string outcome_of(const std::function<std::string()>& work) {
  try {
    return json{{"result", work()}}.dump();
  } catch (const InputError& e) {
    return json{{"key", e.key()}, {"refused", e.what()}}.dump();
  } catch (const std::exception& e) {
    return json{{"failed", e.what()}}.dump();
  }
}

void write_all(int descriptor, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(descriptor, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) return;
    if (count > 0) done += static_cast<std::size_t>(count);
  }
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (;;) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

std::string in_child(const std::function<std::string()>& work) {
  // Flushed, or both processes would print the buffered text.
  std::fflush(nullptr);
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const pid_t child = ::fork();
  if (child < 0) {
    const int error = errno;
    ::close(ends[0]);
    ::close(ends[1]);
    throw std::system_error(error, std::generic_category(), "fork");
  }
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::close(ends[0]);
    write_all(ends[1], outcome_of(work));
    // Ends without the destructors of SystemC's static objects, which are the parent's too.
    ::_exit(0);
  }
  ::close(ends[1]);
  const std::string text = read_all(ends[0]);
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const json answer = json::parse(text, nullptr, false);
  if (answer.is_discarded()) throw std::runtime_error("a run of the platform ended unexpectedly");
  if (answer.contains("refused")) {
    throw InputError(answer["key"].get<std::string>(), answer["refused"].get<std::string>());
  }
  if (answer.contains("failed")) throw std::runtime_error(answer["failed"].get<std::string>());
  return answer["result"].get<std::string>();
}

}  // namespace hvp::app
