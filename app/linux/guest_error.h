#pragma once

#include <stdexcept>

namespace hvp::guest {

// The guest, or what it sent, ends the run: one line that says what was found. Exit status 3.
class GuestError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace hvp::guest
