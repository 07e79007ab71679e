#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <vtkSmartPointer.h>

#include "models/mesh/tet_mesh.h"

class vtkUnstructuredGrid;

// Tetrahedra as VTK's XML unstructured grids, for ParaView. A file's bytes are a function of the
// data alone: the writer fixes index width, compressor and level, and writes no date and no path.
// Every file is written under its name plus ".part" and renamed.

namespace hvp::results {

// The quantities of a step beside the displacement.
struct StepInfo {
  Eigen::Vector3d probe_position_m = Eigen::Vector3d::Zero();  // centre of the probe
  double probe_radius_m = 0.0;
  // Centres of the probes beside the first one, and the body's forces on them.
  std::span<const Eigen::Vector3d> further_probes_m;
  std::span<const Eigen::Vector3d> further_forces_N;
  // Where each probe's proxy is on the deformed surface, or the probe itself without contact. Empty
  // where no contact is a proxy.
  std::span<const Eigen::Vector3d> proxies_m;
  std::span<const int> contact_nodes;                         // mesh nodes, one a contact
  Eigen::Vector3d contact_force_N = Eigen::Vector3d::Zero();  // the body's force on the probe
  // Six values an element, in VTK's order xx yy zz xy yz xz; shear strains as the model has them.
  std::span<const double> strain;
  std::span<const double> stress_Pa;
  std::span<const double> von_mises_Pa;  // one value an element
};

// Writes the deformation over time: `deformation.pvd` lists the steps
// `deformation_<frame, six digits>.vtu`. Points are the rest positions ("Warp By Vector" with the
// array `displacement` shows the deformed body).
//
// Arrays: points `displacement` (m, 64-bit), `anchor`, `contact` (0 or 1); cells `strain`,
// `stress`, `von_mises` (Pa; 32-bit, which halves the files), and of a body with regions `region`
// (0: none, 1: object.region[0], …); fields `time_s`, `frame`,
// `probe_position_m`, `probe_radius_m`, `contact_force_N`; with several probes those of the first
// one, and `probe1_position_m`, `probe1_contact_force_N`, `probe2_position_m`, … Where contact is a
// proxy, `proxy_position_m`, `probe1_proxy_position_m`, … too, which is the probe's own position
// without contact.
//
// The list is written last, so that it never names a step that does not exist.
class DeformationWriter {
 public:
  // Removes the steps and the list that an earlier run left in `directory`, which exists.
  // Anchors are node indices in any order. `regions` has a number for each element, 0 for what no
  // region has, or is empty. Throws std::invalid_argument for an index or a size out of range and
  // std::runtime_error when an old file cannot be removed.
  DeformationWriter(std::filesystem::path directory, const mesh::TetMesh& mesh,
                    std::span<const int> anchors, std::span<const int> regions = {});
  ~DeformationWriter();
  DeformationWriter(const DeformationWriter&) = delete;
  DeformationWriter& operator=(const DeformationWriter&) = delete;

  // Writes a step. `displacement_m` has three entries a node; frames ascend. Throws
  // std::invalid_argument when a size, the contact node or the order does not fit, and
  // std::runtime_error when the file cannot be written.
  void write(double time_s, int frame, std::span<const double> displacement_m,
             const StepInfo& info);

  // Writes the list of steps.
  void finish();

 private:
  struct Step {
    double time_s;
    int frame;
  };

  std::filesystem::path directory_;
  std::size_t nodes_;
  std::size_t elements_;
  vtkSmartPointer<vtkUnstructuredGrid> grid_;
  std::vector<Step> steps_;
};

// "deformation_000042.vtu"
std::string step_file_name(int frame);

// One value for every tetrahedron.
struct ElementQuality {
  std::span<const double> min_dihedral_angle_deg;
  std::span<const double> aspect_ratio;  // longest edge over shortest edge
  std::span<const int> region = {};      // as DeformationWriter has them
};

// Writes the mesh with the cell arrays `min_dihedral_angle_deg` and `aspect_ratio`, and `region`.
// Throws std::invalid_argument when a span does not have one value a tetrahedron,
// std::runtime_error when the file cannot be written.
void write_mesh(const std::filesystem::path& path, const mesh::TetMesh& mesh,
                const ElementQuality& quality);

}  // namespace hvp::results
