#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "app/process/progress.h"
#include "app/scene/scenario.h"
#include "models/accel/board.h"
#include "models/accel/device.h"
#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/fem/locking.h"
#include "models/fixed/spectrum.h"
#include "models/host/frame_computation.h"
#include "models/host/gliding_contact.h"
#include "models/mesh/quality.h"

namespace hvp::vp {
struct SoftBody;
}  // namespace hvp::vp

namespace hvp::app {

// A scenario with its mathematics done: the body is meshed and assembled, and its matrix is in
// words and fits the device (with Limits::reported the fit is not required). A wall has neither
// body nor matrix.
class Scene {
 public:
  // The treatment of a system that does not fit the device, or whose clock the device cannot reach.
  enum class Limits { refused, reported };

  // `device` is the one that accelerator.device names. Throws InputError with the full key of the
  // setting that is wrong.
  Scene(const Scenario& scenario, accel::Device device, const Progress& progress = {},
        Limits limits = Limits::refused);

  const Scenario& scenario() const { return scenario_; }
  // False if [wall] takes the body's place. The body's accessors then throw InputError.
  bool has_body() const { return body_ != nullptr; }
  const fem::Body& body() const { return of_body(body_); }
  host::FrameComputation& computation() { return of_body(computation_); }
  const host::FrameComputation& computation() const { return of_body(computation_); }
  collision::ContactSearch& contacts() { return of_body(contacts_); }
  // What contact by a proxy needs; null where contact is a node's.
  const host::GlideTables* glide() const { return glide_.get(); }
  const collision::ContactSearch& contacts() const { return of_body(contacts_); }
  const mesh::Quality& quality() const { return quality_; }
  // False if the host solves. board() and pattern() then throw InputError, and usage() is empty.
  bool has_board() const { return board_.has_value(); }
  const accel::BoardClocks& board() const;
  const accel::Pattern& pattern() const { return board().pattern(); }
  const accel::Device& device() const { return device_; }
  // The name of the board: "EP2S60", or "2 × EP2S60".
  std::string board_name() const;
  // The usage of one device; of several, that of the device with the least to spare.
  const accel::Usage& usage() const { return usage_; }
  // The clock cycles of a solve that makes all its iterations.
  accel::SolveCycles solve_cycles() const;
  // The spectrum of the system without contact, if the scenario asks for it.
  const std::optional<fixed::SystemSpectrum>& spectrum() const { return spectrum_; }
  const std::optional<fem::Locking>& locking() const { return locking_; }

 private:
  template <class Part>
  static Part& of_body(const std::unique_ptr<Part>& part) {
    if (part == nullptr) refuse_wall();
    return *part;
  }
  [[noreturn]] static void refuse_wall();
  void build_body(const Progress& progress, Limits limits);
  void require_fit() const;
  void require_room_in_registers() const;

  Scenario scenario_;
  accel::Device device_;
  mesh::Quality quality_;
  std::unique_ptr<fem::Body> body_;
  std::unique_ptr<host::FrameComputation> computation_;
  std::unique_ptr<collision::ContactSearch> contacts_;
  std::unique_ptr<host::GlideTables> glide_;
  std::optional<accel::BoardClocks> board_;
  accel::Usage usage_;
  std::optional<fixed::SystemSpectrum> spectrum_;
  std::optional<fem::Locking> locking_;
};

// The settings from which the platform is built. `waveform_file` is the file, without suffix, to
// which [output.waveform] writes.
vp::PlatformSettings platform_settings(const Scene& scene, const std::string& waveform_file = {});

// Builds the body as it is in the servo loop. Keeps a reference to `body`.
std::unique_ptr<fem::Tissue> make_tissue(const Scenario& scenario, const fem::Body& body);

// The true model of a scene's frames, with a state of its own: the body as it is, or as one of
// another material law. Keeps references into the scene.
std::unique_ptr<fem::ReferenceModel> make_reference(
    const Scene& scene, std::optional<tissue::LawKind> law = std::nullopt);

// The same model where contact is a proxy: with one of its own. Else `body` itself.
std::unique_ptr<fem::ReferenceModel> with_own_contact(const Scene& scene,
                                                      std::unique_ptr<fem::ReferenceModel> body);

// The body as the platform takes it. Keeps references into the scene, which must have one.
vp::SoftBody soft_body(Scene& scene);

// Builds the elastic body alone, as `hvp export` needs it.
std::unique_ptr<fem::Body> make_body(const Scenario& scenario, const Progress& progress);

// Refuses a mesh that is far too large before anything of that size is made. A coarse mesh of the
// same body and anchors predicts whether the mesh exceeds the device or its registers by a factor
// of two, or the host's memory if the host factorises the matrix. Closer cases are decided with the
// mesh itself. Throws InputError with the full key.
void require_plausible_size(const Scenario& s, const accel::Device& device,
                            const Progress& progress);

}  // namespace hvp::app
