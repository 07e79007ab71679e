#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "app/results/quality.h"
#include "app/scene/scene.h"
#include "models/host/deviation.h"
#include "models/host/reference_run.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"
#include "vp/frame/ledger.h"

namespace hvp::app {

// The effect [reference]: solves every frame also in the true model and in the rounded model, and
// collects the deviations of the run from both.
class AccuracyTracker : public vp::FrameObserver {
 public:
  AccuracyTracker(const Scene& scene, const host::Reference& settings);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;

  results::Accuracy accuracy() const;
  // The flags matrix_rounding, not_converged, contact_missed, where a contact that was found late
  // is what the error comes from, and those of the rounded matrix.
  stability::Flags flags() const;

 private:
  // The error is of frames in which the run had not found its contact yet.
  bool found_late() const;
  bool has_rounded() const { return rounded_run_ != nullptr && !rounded_run_->singular(); }
  void step(const fem::Hold& hold);

  host::Reference settings_;
  bool has_memory_;
  bool has_board_;
  bool refined_;
  bool glides_;
  bool exact_;             // a linear body is solved for in double precision, by a factorisation
  bool of_another_model_;  // the reference is not of the body's own law
  // With what contact prescribes; where contact is a proxy each reference finds its own.
  std::optional<host::ReferenceRun> linear_run_;
  std::unique_ptr<fem::ReferenceModel> other_run_;
  fem::ReferenceModel& true_run_;  // one of them
  // With the matrix that the board's words stand for; empty where there is no board.
  sparse::BlockMatrix rounded_;
  std::unique_ptr<fem::ReferenceModel> rounded_model_;
  const host::ReferenceRun* rounded_run_ = nullptr;  // of that model, what solves
  std::optional<host::PairedRuns> both_;  // where there is a rounded model that can be solved
  host::Deviation displacement_, force_;
  host::Deviation displacement_rounded_, force_rounded_;
  fem::KeptHold skipped_;  // of the last frame of a static body, where it was not compared
  bool has_skipped_ = false;
  std::optional<vp::Picoseconds> last_time_;
  double period_s_;
  std::vector<Eigen::Vector3d> forces_;  // of the current frame, one a probe
  std::int64_t in_contact_ = 0;
  std::int64_t compared_ = 0;  // of those
};

}  // namespace hvp::app
