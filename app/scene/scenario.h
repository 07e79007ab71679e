#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/collision/contact_settings.h"
#include "models/config/declaration.h"
#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/dynamics.h"
#include "models/fem/loads.h"
#include "models/fem/material.h"
#include "models/fixed/settings.h"
#include "models/host/guest_costs.h"
#include "models/host/reference_run.h"
#include "models/host/refinement.h"
#include "models/mesh/mesh_settings.h"
#include "models/mesh/region.h"
#include "models/sparse/spectrum.h"
#include "vp/platform_settings.h"

// A scenario as it is read: the tables of the parts, put together. docs/scenario-reference.md is
// made from this declaration.
namespace hvp::app {

// [budget]: what has to hold.
struct Budget {
  double period_s = 2e-3;
  // Of |v − v_ref| / |v_ref|; 0: not stated.
  double displacement_error = 0;
  double force_error = 0;

  bool states_errors() const { return displacement_error > 0 || force_error > 0; }

  void declare(config::Visitor& v);
};

// [[object.anchor]]: a region whose nodes are held.
struct Anchor {
  mesh::Region region;

  void declare(config::Visitor& v);
};

// [object]: the soft body.
struct Object {
  mesh::MeshSettings mesh;
  fem::Material material;
  fem::AnchorTreatment anchored_nodes = fem::AnchorTreatment::removed;
  std::vector<Anchor> anchors;

  void declare(config::Visitor& v);
  void check() const;
};

// [contact]
struct Contact {
  collision::ContactSettings search;
  fem::ContactDiagonal diagonal = fem::ContactDiagonal::average;

  void declare(config::Visitor& v);
};

// [output.waveform]: what the cycle-accurate engine does, clock by clock, in engine.vcd.
struct WaveformSettings {
  int first_frame = 0;
  int frames = 1;

  void declare(config::Visitor& v);
};

// [output]
struct Output {
  int deformation_every_frames = 25;
  int trace_frames = 1000;
  double trace_bytes = 64e6;
  bool pictures = true;
  bool remedies = true;
  std::optional<WaveformSettings> waveform;

  void declare(config::Visitor& v);
};

// What is simulated stands first; declare() says where it is in the file.
struct Scenario : vp::SystemSettings {
  std::string title;
  Budget budget;
  Object object;
  fem::Loads loads;
  std::optional<fem::Dynamics> dynamics;
  Contact contact;
  fixed::Settings solver;
  std::optional<host::Refinement> refinement;
  std::optional<host::GuestCosts> guest;
  std::optional<host::Reference> reference;
  std::optional<sparse::SpectrumSettings> spectrum;
  Output output;

  void declare(config::Visitor& v);
  // One a device and a user; the DAQ board's registers have room for sixteen.
  static constexpr std::size_t kMostProbes = 8;
  bool timing_only() const { return fidelity.numbers == vp::Numbers::none; }
  // Throws InputError for an effect that needs what is not there, and for keys that rule each other
  // out.
  void check() const;

 private:
  void declare_refinement(config::Visitor& v);
};

}  // namespace hvp::app
