#include "app/run/deformation_recorder.h"

#include <array>
#include <cstddef>

#include "models/fem/strain.h"
#include "models/index.h"

namespace hvp::app {

namespace {
// ParaView takes six components as xx yy zz xy yz xz; the model's order is in fem/material.h.
template <class Six>
void append(std::vector<double>& values, const Six& v) {
  static constexpr std::array<int, 6> kOrder = {0, 1, 2, 3, 5, 4};
  for (const int i : kOrder) values.push_back(v[i]);
}
}  // namespace

DeformationRecorder::DeformationRecorder(const std::filesystem::path& directory, const Scene& scene)
    : scene_(scene),
      every_frames_(scene.scenario().output.deformation_every_frames),
      writer_(directory, scene.body().mesh(), scene.body().anchored(),
              scene.body().materials().of_elements()),
      displacement_(3 * scene.body().mesh().nodes.size()) {}

void DeformationRecorder::solved(const vp::Frame& frame, const vp::Solution& solution) {
  if (frame.number % every_frames_ != 0) return;
  const fem::Body& body = scene_.body();
  body.expand(solution.displacement, displacement_);
  strain_.clear();
  stress_.clear();
  von_mises_.clear();
  for (const fem::ElementStress& e :
       fem::element_stress(body.mesh(), body.materials(), displacement_)) {
    append(strain_, e.strain);
    append(stress_, e.stress);
    von_mises_.push_back(e.von_mises_pa);
  }
  results::StepInfo info;
  info.probe_position_m = frame.touch().tip;
  info.probe_radius_m = scene_.scenario().probes.front().radius;
  contact_nodes_.clear();
  for (const collision::Touch& touch : frame.touches) {
    if (touch.contact.present()) contact_nodes_.push_back(touch.contact.node);
  }
  info.contact_nodes = contact_nodes_;
  further_probes_.clear();
  further_forces_.clear();
  for (std::size_t i = 1; i < frame.touches.size(); ++i) {
    further_probes_.push_back(frame.touches[i].tip);
    further_forces_.emplace_back(-frame.touches[i].force);
  }
  info.further_probes_m = further_probes_;
  info.further_forces_N = further_forces_;
  proxies_.clear();
  if (scene_.glide() != nullptr) {
    for (const collision::Touch& touch : frame.touches) proxies_.push_back(place(touch));
  }
  info.proxies_m = proxies_;
  info.contact_force_N = -frame.touch().force;
  info.strain = strain_;
  info.stress_Pa = stress_;
  info.von_mises_Pa = von_mises_;
  writer_.write(to_seconds(frame.time), static_cast<int>(frame.number), displacement_, info);
}

Eigen::Vector3d DeformationRecorder::place(const collision::Touch& touch) const {
  const collision::SurfaceSpot& spot = touch.contact.spot;
  if (!spot.present()) return touch.tip;
  const mesh::TetMesh& mesh = scene_.body().mesh();
  Eigen::Vector3d place = touch.foot;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto node = static_cast<std::size_t>(mesh.boundary[at(spot.triangle)][k]);
    place += spot.weight[static_cast<Eigen::Index>(k)] *
             Eigen::Map<const Eigen::Vector3d>(&displacement_[3 * node]);
  }
  return place;
}

}  // namespace hvp::app
