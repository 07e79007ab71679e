#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/collision/contact.h"
#include "models/config/declaration.h"
#include "models/config/effects.h"
#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/loads.h"
#include "models/fem/material.h"
#include "models/fem/newmark.h"
#include "models/fem/region.h"
#include "models/fem/renewal.h"
#include "models/fixed/settings.h"
#include "models/host/costs.h"
#include "models/host/deviation.h"
#include "models/host/refinement.h"
#include "models/mesh/mesh_settings.h"
#include "models/mesh/region.h"
#include "models/sparse/spectrum.h"
#include "models/tissue/model.h"
#include "vp/platform_settings.h"

// The scenario: the tables of all parts together. docs/scenario-reference.md is generated from this
// declaration.
namespace hvp::app {

// [budget]: the limits that a run has to meet.
struct Budget {
  double period_s = 2e-3;
  // The limits on |v − v_ref| / |v_ref|; 0: not stated.
  double displacement_error = 0;
  double force_error = 0;
  // The least gain margin of a loop that is closed.
  double gain_margin = 1;

  bool states_errors() const { return displacement_error > 0 || force_error > 0; }

  void declare(config::Visitor& v);
};

// [[object.anchor]]: a region whose nodes have the prescribed displacement zero.
struct Anchor {
  mesh::Region region;

  void declare(config::Visitor& v);
};

// [object]: the deformable body.
struct Object {
  mesh::MeshSettings mesh;
  fem::Material material;
  std::optional<tissue::Model> model;
  bool is_solved = true;  // false with explicit steps; set by Scenario::declare()
  fem::Elements elements = fem::Elements::linear;
  fem::AnchorTreatment anchored_nodes = fem::AnchorTreatment::removed;
  std::vector<Anchor> anchors;
  std::vector<fem::Region> regions;

  // True if the body's forces are not K·u: a frame is then solved by increments.
  bool nonlinear() const { return model && !model->linear(); }
  tissue::LawKind law() const { return model ? model->kind : tissue::LawKind::linear; }
  // How often the matrix is renewed; never where the scenario does not say.
  fem::MatrixRenewal renewal() const {
    return model && model->matrix ? *model->matrix : fem::MatrixRenewal{};
  }
  void declare(config::Visitor& v);
  void check() const;
};

// [contact]
struct Contact {
  collision::ContactSettings search;
  fem::ContactDiagonal diagonal = fem::ContactDiagonal::average;

  void declare(config::Visitor& v);
};

// [output.waveform]: records the cycle-accurate engine, clock by clock, in engine.vcd, and the one
// in SystemVerilog in engine.fst.
struct WaveformSettings {
  int first_frame = 0;
  int frames = 1;

  void declare(config::Visitor& v);
};

// [output.engine_port]: records the port of the engine in SystemVerilog in engine-port.txt.
struct EnginePortSettings {
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
  std::optional<EnginePortSettings> engine_port;

  void declare(config::Visitor& v);
};

// All tables of a scenario; those of the platform are in the base class. declare() defines their
// order in the file.
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
  // The most probes; each has a device and a user. The DAQ board's registers have room for sixteen.
  static constexpr std::size_t kMostProbes = 8;
  // The key of a probe's table: "probe", or "probe[1]" where there are several.
  std::string probe_key(std::size_t probe) const {
    return probes.size() > 1 ? "probe[" + std::to_string(probe) + "]" : "probe";
  }
  // The key of the table that describes a probe's device: "device", or "probe[1].device".
  std::string device_key(std::size_t probe) const {
    return probes.at(probe).device ? probe_key(probe) + ".device" : "device";
  }
  // All effects, absent ones included, those of probes' own devices last.
  std::vector<config::Effect> effects() const;
  // True if [reference] is of another material law than the body: it judges the model then.
  bool judged_by_another_model() const {
    if (!reference || !reference->model) return false;
    return *reference->model != object.law() || (object.model && object.model->springs);
  }
  // True where a frame depends on those before it.
  bool has_memory() const {
    return dynamics || (object.model && !object.model->prony.empty()) ||
           (!wall && contact.search.glides());
  }
  bool timing_only() const { return fidelity.numbers == vp::Numbers::none; }
  // Throws InputError if an effect lacks what it needs, and for keys that exclude each other.
  void check() const;

 private:
  void declare_refinement(config::Visitor& v);
};

// Throws InputError, with a key of the fault's, for a fault that cannot occur in this scenario.
void require_possible(const Scenario& scenario, const vp::Fault& fault);

// Runs a step of a part and completes the key of an InputError with the part's table.
template <class Step>
auto within(const std::string& table, const Step& step) {
  try {
    return step();
  } catch (const InputError& e) {
    throw InputError(e.key().empty() ? table : table + "." + e.key(), e.what());
  }
}

}  // namespace hvp::app
