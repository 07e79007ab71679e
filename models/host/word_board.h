#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "models/fixed/solver.h"
#include "models/fixed/system.h"

namespace hvp::host {

// The board's arithmetic without its bus and its clock: the matrix in words, with the contact's
// rows and columns cleared as the driver clears them, and the solver, which keeps U from one solve
// to the next.
class WordBoard {
 public:
  // `settings` are BoardSystem::settings().
  WordBoard(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings);

  // Sets the contact nodes (active, ascending); `diagonal` is the word on their diagonals.
  void set_contact(std::span<const int> nodes, std::int32_t diagonal);
  // Takes other values of the same pattern, and keeps the contact.
  void renew(const fixed::QuantisedMatrix& matrix, std::int32_t diagonal);
  fixed::Report solve(std::span<const std::int32_t> b);
  std::span<const std::int32_t> solution() const { return x_; }

 private:
  fixed::QuantisedMatrix matrix_;
  fixed::Settings settings_;
  std::unique_ptr<fixed::Solver> solver_;
  std::vector<int> contact_;
  std::vector<std::vector<std::int32_t>> rows_;  // the contact's rows before they were cleared
  std::vector<std::int32_t> x_;
  std::vector<std::int32_t> previous_;  // the solution before, for Start::extrapolated
};

}  // namespace hvp::host
