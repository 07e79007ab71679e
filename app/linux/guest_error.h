#pragma once

#include <stdexcept>

namespace hvp::guest {

// A fault of the guest or of its messages that ends the run with exit status 3. what() is one line
// that describes it.
class GuestError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The guest is there and does not go on.
class GuestHung : public GuestError {
  using GuestError::GuestError;
};

}  // namespace hvp::guest
