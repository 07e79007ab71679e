#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace hvp::test {

// What `work` returns, made in a child process: SystemC elaborates once in a process, and a test
// that compares two runs needs two. Call it before anything of SystemC is built. Empty where the
// child did not come to its end.
template <class Work>
std::vector<std::int64_t> in_child_process(const Work& work) {
  int ends[2] = {-1, -1};
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const std::vector<std::int64_t> numbers = work();
    const auto* bytes = reinterpret_cast<const char*>(numbers.data());
    std::size_t left = numbers.size() * sizeof(std::int64_t);
    while (left > 0) {
      const ssize_t written = write(ends[1], bytes, left);
      if (written <= 0) _exit(1);
      bytes += written;
      left -= static_cast<std::size_t>(written);
    }
    _exit(0);
  }
  close(ends[1]);
  std::vector<std::int64_t> numbers;
  std::vector<char> bytes;
  char buffer[65536];
  for (ssize_t count = 0; (count = read(ends[0], buffer, sizeof(buffer))) > 0;) {
    bytes.insert(bytes.end(), buffer, buffer + count);
  }
  close(ends[0]);
  int status = 1;
  waitpid(child, &status, 0);
  if (status != 0) return {};
  numbers.resize(bytes.size() / sizeof(std::int64_t));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(numbers.data()));
  return numbers;
}

}  // namespace hvp::test
