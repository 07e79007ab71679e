#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/results/part_files.h"
#include "models/host/wall.h"
#include "models/plant/plant.h"
#include "models/plant/trajectory.h"
#include "vp/frame/ledger.h"

namespace hvp::results {

// `times`: a run for timing only, in which forces and words have empty fields.
enum class Columns { all, times };

// A column of frames.csv with a line of help.
struct FrameColumn {
  std::string name;
  std::string help;
};
// All columns in their order.
std::vector<FrameColumn> frame_columns();

// What a probe has columns of.
struct ProbeColumnsOf {
  plant::Trajectory probe;
  bool device = false;              // it has mass
  bool currents = false;            // and motors
  std::optional<plant::Hand> hand;  // the hand that intends the motion
  bool structure = false;           // the hand holds a handle
};
// The reason for further columns at the end of a line: further probes, proxies, devices with mass,
// and bits that flip.
struct ProbeColumns {
  std::vector<ProbeColumnsOf> probes = std::vector<ProbeColumnsOf>(1);
  std::optional<host::Wall> wall;  // whose spring has energy at the start
  bool tools = false;              // the host has a virtual coupling
  bool passivity = false;          // the host has a passivity controller
  bool proxies = false;            // contact is a proxy
  bool flips = false;              // there is a fault of kind flip
};
// The columns of probe `index`. Names of further probes have a prefix such as "probe1_".
std::vector<FrameColumn> probe_columns(const ProbeColumns& of, std::size_t index);

// Writes frames.csv: a line a frame, with times since the servo loop began.
class FramesCsv : public vp::FrameObserver {
 public:
  FramesCsv(const std::filesystem::path& path, vp::Picoseconds budget,
            Columns columns = Columns::all, ProbeColumns probes = {});

  void closed(const vp::Frame& frame, const vp::CriticalPath& path) override;
  void finish() { stream_.finish(); }

 private:
  PartStream stream_;
  vp::Picoseconds budget_;
  std::string proxy_fields(const vp::Frame& frame, std::size_t index) const;
  std::string port_fields(const vp::Frame& frame, std::size_t index) const;
  std::string device_fields(const vp::Frame& frame, std::size_t index);

  Columns columns_;
  ProbeColumns probes_;
  std::vector<std::optional<double>>
      at_start_J_;  // in the wall's spring in the first frame, one a probe
};

}  // namespace hvp::results
