#pragma once

#include <filesystem>
#include <vector>

#include "app/results/vtu_files.h"
#include "app/scene/scene.h"
#include "vp/frame/ledger.h"

namespace hvp::app {

// Writes the deformation, with strain and stress, for ParaView. The scenario says every how many
// frames.
class DeformationRecorder : public vp::FrameObserver {
 public:
  DeformationRecorder(const std::filesystem::path& directory, const Scene& scene);

  void solved(const vp::Frame& frame, const vp::Solution& solution) override;
  void finish() { writer_.finish(); }

 private:
  // Where a probe's proxy is on the deformed surface, m; the tip without contact.
  Eigen::Vector3d place(const collision::Touch& touch) const;

  const Scene& scene_;
  int every_frames_;
  results::DeformationWriter writer_;
  std::vector<double> displacement_;
  std::vector<double> strain_, stress_, von_mises_;
  std::vector<Eigen::Vector3d> further_probes_;
  std::vector<Eigen::Vector3d> further_forces_;
  std::vector<Eigen::Vector3d> proxies_;
  std::vector<int> contact_nodes_;
};

}  // namespace hvp::app
