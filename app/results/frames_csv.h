#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/results/part_stream.h"
#include "models/plant/hand.h"
#include "models/plant/trajectory.h"
#include "vp/frame/observer.h"

namespace hvp::results {

// Timing only, nobody computes forces or words: their fields are empty.
enum class Columns { all, times };

// The columns of frames.csv in their order, with a line of help.
struct FrameColumn {
  std::string name;
  std::string help;
};
std::vector<FrameColumn> frame_columns();

// What frames.csv has more of, behind its other columns: each further probe, and devices with mass.
struct ProbeColumns {
  std::vector<plant::Trajectory> probes = std::vector<plant::Trajectory>(1);
  bool devices = false;             // they have mass
  bool currents = false;            // and motors
  std::optional<plant::Hand> hand;  // who intends the motion
};
// Of probe `index`; its names have the prefix "probe1_" but for the first one's.
std::vector<FrameColumn> probe_columns(const ProbeColumns& of, std::size_t index);

// frames.csv: a line a frame, times since the servo loop began.
class FramesCsv : public vp::FrameObserver {
 public:
  FramesCsv(const std::filesystem::path& path, vp::Picoseconds budget,
            Columns columns = Columns::all, ProbeColumns probes = {});

  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;
  void finish() { stream_.finish(); }

 private:
  PartStream stream_;
  vp::Picoseconds budget_;
  std::string device_fields(const vp::Frame& frame, std::size_t index) const;

  Columns columns_;
  ProbeColumns probes_;
};

}  // namespace hvp::results
