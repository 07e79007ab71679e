#include "tests/app/sample_run.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "app/results/vtu_files.h"

namespace hvp::sample {
namespace {

constexpr double kRadius = 0.05;
constexpr double kProbeRadius = 0.005;
constexpr double kDepth = 0.010;
constexpr double kPeriod_us = 2000.0;

// The faces that one tetrahedron alone has.
std::vector<std::array<int, 3>> boundary_of(const std::vector<std::array<int, 4>>& tetrahedra) {
  using Face = std::array<int, 3>;
  std::vector<std::pair<Face, Face>> faces;  // sorted nodes, nodes as the normal points out
  for (const auto& t : tetrahedra)
    for (const Face& f : {Face{t[0], t[2], t[1]}, Face{t[0], t[1], t[3]}, Face{t[1], t[2], t[3]},
                          Face{t[0], t[3], t[2]}}) {
      Face key = f;
      std::sort(key.begin(), key.end());
      faces.emplace_back(key, f);
    }
  std::sort(faces.begin(), faces.end());
  std::vector<Face> boundary;
  for (std::size_t i = 0; i < faces.size();) {
    const bool shared = i + 1 < faces.size() && faces[i].first == faces[i + 1].first;
    if (!shared) boundary.push_back(faces[i].second);
    i += shared ? 2 : 1;
  }
  return boundary;
}

// A field that falls off like a point load's and vanishes towards the lowest nodes.
std::vector<double> pressed(const mesh::TetMesh& mesh, const Eigen::Vector3d& at, double depth) {
  std::vector<double> u;
  for (const auto& x : mesh.nodes) {
    const double decay = 0.008 / (0.008 + (x - at).norm());
    const double held = std::clamp((x.z() + 0.8 * kRadius) / (1.8 * kRadius), 0.0, 1.0);
    const Eigen::Vector3d outward(x.x(), x.y(), 0.0);
    const Eigen::Vector3d v =
        depth * held * (-decay * Eigen::Vector3d::UnitZ() + decay * (1 - decay) * 8.0 * outward);
    u.insert(u.end(), {v.x(), v.y(), v.z()});
  }
  return u;
}

// How far the probe is in at a frame, 0 to 1: off, in and off again.
double pressed_share(int frame, int frames) {
  const double phase = 1.25 * frame / frames - 0.125;
  return phase > 0.0 && phase < 1.0 ? std::sin(std::numbers::pi * phase) : 0.0;
}

void write_deformation(const std::filesystem::path& directory, const RunShape& shape) {
  const mesh::TetMesh mesh = ball(kRadius, shape.cells);
  const std::vector<int> anchors = lowest_nodes(mesh, 0.1);
  const auto top = std::max_element(mesh.nodes.begin(), mesh.nodes.end(),
                                    [](const auto& a, const auto& b) { return a.z() < b.z(); });
  const std::size_t elements = mesh.tetrahedra.size();
  const std::vector<double> tensors(6 * elements, 0.0);
  const std::vector<double> scalars(elements, 0.0);

  std::vector<int> regions;
  for (std::size_t e = 0; shape.lump && e < elements; ++e) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const int node : mesh.tetrahedra[e]) centre += mesh.nodes[static_cast<std::size_t>(node)];
    regions.push_back(centre.norm() / 4 < 0.5 * kRadius ? 1 : 0);
  }
  results::DeformationWriter writer(directory, mesh, anchors, regions);
  for (int frame = 0; frame < shape.frames; frame += shape.step_every) {
    const double press = pressed_share(frame, shape.frames);
    const int contact = static_cast<int>(top - mesh.nodes.begin());
    results::StepInfo info;
    info.probe_position_m =
        *top + Eigen::Vector3d(0.0, 0.0, kProbeRadius - kDepth * press + (press > 0 ? 0 : 0.01));
    info.probe_radius_m = kProbeRadius;
    if (press > 0) {
      info.contact_nodes = {&contact, 1};
      info.contact_force_N = Eigen::Vector3d(0.02, 0.0, 1.2) * press;
    }
    info.strain = tensors;
    info.stress_Pa = tensors;
    info.von_mises_Pa = scalars;
    writer.write(frame * kPeriod_us * 1e-6, frame, pressed(mesh, *top, kDepth * press), info);
  }
  writer.finish();
}

const std::vector<std::tuple<const char*, const char*, double>> kWorstFrame = {
    {"host", "release", 4.0},       {"device", "sample", 1.0},     {"daq", "convert", 18.0},
    {"pci", "read position", 12.0}, {"host", "contact", 3.0},      {"host", "force vector", 9.0},
    {"pci", "write b", 41.5},       {"pci", "wait for bus", 60.0}, {"accelerator", "solve", 700.25},
    {"pci", "interrupt", 11.0},     {"pci", "read U", 48.75},      {"pci", "wait for bus", 100.0},
    {"host", "force", 6.5},         {"pci", "write force", 10.0},  {"daq", "output", 8.0}};
constexpr double kWorst_us = 1033.0;  // the sum

void write_frames(const std::filesystem::path& directory, const RunShape& shape) {
  std::ofstream csv(directory / "frames.csv", std::ios::binary);
  csv << "frame,born_us,latency_us,load_us,deadline_us,in_time,contact_node,force_N\n";
  std::uint32_t state = 12345;
  for (int frame = 0; frame < shape.frames; ++frame) {
    state = state * 1664525u + 1013904223u;  // Numerical Recipes' generator: scatter for the eye
    const double press = pressed_share(frame, shape.frames);
    const double latency =
        frame == shape.frames / 3
            ? kWorst_us
            : 842.0 + 40.0 * (state >> 8) / double(1u << 24) + (frame % 61 == 17 ? 90.0 : 0.0);
    const double born = frame * kPeriod_us;
    csv << fmt::format("{},{},{:.3f},{:.3f},{},1,{},{:.6f}\n", frame, born, latency, latency + 35.0,
                       born + kPeriod_us, press > 0 ? 42 : -1, 1.2 * press);
  }
}

void write_summary(const std::filesystem::path& directory) {
  nlohmann::ordered_json summary;
  summary["deadline"] = {
      {"period_us", kPeriod_us}, {"worst_us", kWorst_us}, {"budget_us", kPeriod_us}, {"misses", 0}};
  for (const auto& [part, phase, us] : kWorstFrame)
    summary["attribution"].push_back({{"part", part}, {"phase", phase}, {"us", us}});
  std::ofstream(directory / "summary.json", std::ios::binary) << summary.dump(2) << '\n';
}

}  // namespace

mesh::TetMesh ball(double radius_m, int cells) {
  mesh::TetMesh mesh;
  const int side = cells + 1;
  const auto index = [side](int i, int j, int k) { return (i * side + j) * side + k; };
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      for (int k = 0; k < side; ++k) {
        const Eigen::Vector3d cube =
            Eigen::Vector3d(i, j, k) * (2.0 / cells) - Eigen::Vector3d::Ones();
        const double norm = cube.norm();
        const double scale = norm > 0 ? cube.cwiseAbs().maxCoeff() / norm : 0.0;
        mesh.nodes.push_back(radius_m * scale * cube);
      }
  // Six tetrahedra around the diagonal of each cell, one for every order of the axes.
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (int k = 0; k < cells; ++k) {
        std::array<int, 3> order = {0, 1, 2};
        do {
          std::array<int, 3> corner = {i, j, k};
          std::array<int, 4> t = {index(i, j, k), 0, 0, 0};
          for (std::size_t step = 0; step < 3; ++step) {
            ++corner[static_cast<std::size_t>(order[step])];
            t[step + 1] = index(corner[0], corner[1], corner[2]);
          }
          const auto node = [&](std::size_t c) {
            return mesh.nodes[static_cast<std::size_t>(t[c])];
          };
          if (mesh::jacobian_determinant(node(0), node(1), node(2), node(3)) < 0)
            std::swap(t[2], t[3]);
          mesh.tetrahedra.push_back(t);
        } while (std::next_permutation(order.begin(), order.end()));
      }
  mesh.boundary = boundary_of(mesh.tetrahedra);
  return mesh;
}

std::vector<int> lowest_nodes(const mesh::TetMesh& mesh, double fraction) {
  std::vector<int> nodes(mesh.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  std::stable_sort(nodes.begin(), nodes.end(), [&](int a, int b) {
    return mesh.nodes[static_cast<std::size_t>(a)].z() <
           mesh.nodes[static_cast<std::size_t>(b)].z();
  });
  nodes.resize(static_cast<std::size_t>(fraction * static_cast<double>(nodes.size())));
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

void write_run(const std::filesystem::path& directory, const RunShape& shape) {
  write_deformation(directory, shape);
  write_frames(directory, shape);
  write_summary(directory);
}

}  // namespace hvp::sample
