#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace hvp::draw {

// The data of a step of deformation.pvd that the picture needs. Lengths in metres.
struct DeformationStep {
  std::vector<Eigen::Vector3d> rest;
  std::vector<Eigen::Vector3d> displacement;
  std::vector<std::array<int, 4>> tetrahedra;  // eight for a ten-node one
  std::vector<int> regions;  // of each tetrahedron, 0: none; empty for a body without regions
  std::vector<int> anchors;  // node indices, ascending
  int contact_node = -1;     // -1: none
  double time_s = 0.0;
  int frame = 0;
  Eigen::Vector3d probe = Eigen::Vector3d::Zero();  // of a proxy, on the deformed surface
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    // of the device
  double probe_radius = 0.0;
  struct Probe {
    Eigen::Vector3d place;
    Eigen::Vector3d force_N;  // the body's force on the probe
    Eigen::Vector3d tip = place;
  };
  std::vector<Probe> further_probes;
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();  // the body's force on the first probe
};

// The steps' file names in the list's order. Throws hvp::InputError when the list cannot be
// read or names no step.
std::vector<std::string> listed_steps(const std::filesystem::path& list);

// Reads and checks a step. Throws hvp::InputError for a file that is missing, damaged, without
// one of the arrays, with cells that are not tetrahedra or with numbers that are not finite.
DeformationStep read_step(const std::filesystem::path& path);

// Reads the contact force of a step in newtons, without the mesh's arrays. Throws as read_step.
double contact_force_of(const std::filesystem::path& path);

// Reads the listed step with the largest contact force; the last one where no step has any.
DeformationStep read_deepest_step(const std::filesystem::path& run_directory);

}  // namespace hvp::draw
