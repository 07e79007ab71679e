#pragma once

#include <array>
#include <functional>
#include <string>

#include <sys/wait.h>
#include <unistd.h>

namespace hvp::test {

// What `write_to` put into its text in a child process; empty where that failed. SystemC elaborates
// once in a process, so that a test that compares two platforms runs them in children.
inline std::string output_of_child(const std::function<void(std::string&)>& write_to) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    std::string text;
    write_to(text);
    for (std::size_t done = 0; done < text.size();) {
      const ssize_t n = write(ends[1], text.data() + done, text.size() - done);
      if (n <= 0) _exit(1);
      done += static_cast<std::size_t>(n);
    }
    _exit(0);
  }
  close(ends[1]);
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; (n = read(ends[0], buffer.data(), buffer.size())) > 0;) {
    text.append(buffer.data(), static_cast<std::size_t>(n));
  }
  close(ends[0]);
  int status = 1;
  waitpid(child, &status, 0);
  return status == 0 ? text : std::string();
}

}  // namespace hvp::test
