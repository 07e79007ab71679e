#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace hvp {

// An error in the program's input. The command line prints it as one line and exits with status 2.
//
// `key` is the scenario key that is to blame ("object.mesh.nodes"), relative to the part that
// throws; the scenario reader completes it and finds its line. It is empty where no key is meant.
// The message states the value that was found and the values that were expected, numbers included,
// and does not repeat the key.
class InputError : public std::runtime_error {
 public:
  explicit InputError(const std::string& message) : std::runtime_error(message) {}
  InputError(std::string key, const std::string& message)
      : std::runtime_error(message), key_(std::move(key)) {}

  const std::string& key() const { return key_; }

 private:
  std::string key_;
};

}  // namespace hvp
