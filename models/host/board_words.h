#pragma once

#include <span>
#include <vector>

#include "models/fem/contact.h"
#include "models/fem/tissue.h"
#include "models/host/board_system.h"
#include "models/host/frame_method.h"

namespace hvp::host {

// The method in which the board solves for u itself, in one pass (thesis Fig. 6.2): the modified
// force vector goes there in words, U comes back. Where operations are only counted, right-hand
// sides stay as they are.
class BoardWords final : public FrameMethod {
 public:
  // Keeps references. `initial` is the displacement before the first frame.
  BoardWords(const fem::ContactConstraint& constraint, const BoardSystem& board,
             std::span<const double> initial, fem::Effort effort);

  void begin(std::span<const double> f, const fem::Hold& hold) override;
  void go_on(std::span<const double> f, double way) override;
  bool next(std::span<std::int32_t> b) override;
  void accept(std::span<const std::int32_t> x, stability::Flags flags) override;

  std::span<const double> displacement() const override { return u_; }
  stability::Flags flags() const override { return flags_; }
  std::int64_t clamped() const override { return clamped_; }

  double next_operations() const override { return next_operations_; }
  double force_operations() const override {
    return conversion();
  }  // the conversion of U from its words
  std::vector<Step> steps() const override;

 private:
  double conversion() const;
  void look_for_words(std::span<const std::int32_t> b);

  const fem::ContactConstraint& constraint_;
  const BoardSystem& board_;
  fem::Effort effort_;
  std::span<const double> f_;
  fem::Hold hold_;
  std::vector<double> b_;
  std::vector<double> u_;
  bool sent_ = false;
  double next_operations_ = 0;
  stability::Flags flags_;
  std::int64_t clamped_ = 0;
  bool vanished_ = false;         // all words of this frame's load are zero
  int frames_without_words_ = 0;  // in a row, while the contact is displaced
};

}  // namespace hvp::host
