#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "app/scene/scenario.h"
#include "models/accel/board_clocks.h"
#include "models/accel/board_memory.h"
#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/fem/locking.h"
#include "models/fixed/spectrum.h"
#include "models/host/frame_computation.h"
#include "models/mesh/quality.h"

namespace hvp::app {

using Progress = std::function<void(std::string_view)>;

// A scenario with its mathematics done: the body is meshed and assembled, its matrix is in words
// and is known to fit the device unless Limits::reported was asked for. A wall has neither.
class Scene {
 public:
  // What becomes of a system that the device cannot hold, or a clock that it does not reach.
  enum class Limits { refused, reported };

  // `device` is what accelerator.device names. Throws InputError with the full key of what is to
  // blame.
  Scene(const Scenario& scenario, accel::Device device, const Progress& progress = {},
        Limits limits = Limits::refused);

  const Scenario& scenario() const { return scenario_; }
  // False where [wall] stands in the body's place. What is asked of the body then throws
  // InputError.
  bool has_body() const { return body_ != nullptr; }
  const fem::Body& body() const { return of_body(body_); }
  host::FrameComputation& computation() { return of_body(computation_); }
  const host::FrameComputation& computation() const { return of_body(computation_); }
  collision::ContactSearch& contacts() { return of_body(contacts_); }
  const collision::ContactSearch& contacts() const { return of_body(contacts_); }
  const mesh::Quality& quality() const { return quality_; }
  // False where the host solves: board() and pattern() then throw InputError, usage() is empty.
  bool has_board() const { return board_.has_value(); }
  const accel::BoardClocks& board() const;
  const accel::Pattern& pattern() const { return board().pattern(); }
  const accel::Device& device() const { return device_; }
  // "EP2S60", or "2 × EP2S60".
  std::string board_name() const;
  // Of one device, the one with the least to spare.
  const accel::Usage& usage() const { return usage_; }
  // Of a solve that makes all its iterations.
  accel::SolveCycles solve_cycles() const;
  // Of the system without contact; where the scenario asks for it.
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
  std::optional<accel::BoardClocks> board_;
  accel::Usage usage_;
  std::optional<fixed::SystemSpectrum> spectrum_;
  std::optional<fem::Locking> locking_;
};

// What the platform is built from. `waveform_file` is where [output.waveform] writes to, if it is
// there: a file's name without its suffix.
vp::PlatformSettings platform_settings(const Scene& scene, const std::string& waveform_file = {});

// The elastic body alone, as `hvp export` needs it.
std::unique_ptr<fem::Body> make_body(const Scenario& scenario, const Progress& progress);

}  // namespace hvp::app
