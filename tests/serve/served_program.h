#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/app/cli/program.h"
#include "tests/app/scratch_directory.h"
#include "tests/serve/raw_client.h"

namespace hvp::test {

// `hvp serve` of a small scene, from when it listens. ctest ends a test that hangs.
class ServedProgram {
 public:
  explicit ServedProgram(const std::vector<std::string>& more = {}) {
    cli::write(place_.path() / "s.toml", cli::kSmallScene);
    std::vector<std::string> words = {"serve", "s.toml", "--quiet", "--vfio-user", "board"};
    words.insert(words.end(), more.begin(), more.end());
    program_.emplace(place_.path(), words);
    while (program_->out().find('\n') == std::string::npos) {
      if (program_->ended()) throw std::runtime_error(program_->wait().err);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  std::filesystem::path socket() const { return place_.path() / "board"; }
  const std::filesystem::path& folder() const { return place_.path(); }
  cli::Program& program() { return *program_; }

  std::ptrdiff_t open_files() const {
    const std::filesystem::directory_iterator files(proc() / "fd");
    return std::distance(begin(files), end(files));
  }
  bool maps(const std::string& name) const {
    return cli::read(proc() / "maps").find(name) != std::string::npos;
  }
  // The server answers a new client: what the one before left is cleared by then.
  void expect_service() {
    RawClient client(socket());
    EXPECT_TRUE(client.agree());
    client.close();
  }
  cli::Ended end_by(int signal) {
    program_->signal(signal);
    return program_->wait();
  }

 private:
  std::filesystem::path proc() const {
    return std::filesystem::path("/proc") / std::to_string(program_->pid());
  }

  ScratchDirectory place_;
  std::optional<cli::Program> program_;
};

}  // namespace hvp::test
