#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "app/scene/scenario.h"
#include "models/config/effects.h"
#include "models/config/input_error.h"
#include "models/plant/device.h"
#include "vp/fpga/rtl_timing.h"

// Scenario::check(): refuses keys that are each right and cannot be together.

namespace hvp::app {

namespace {

// Refuses capabilities of what the board does not have.
void require_possible(const vp::PciFunction& function, const Scenario& s) {
  if (function.pci_express && !s.bus.pcie) {
    throw InputError("function.pci_express",
                     "the board is on the PCI bus and has no link to speak of: expected false, or "
                     "[bus.pcie]");
  }
  if (function.msi_x && s.transfer.notification != link::Notification::msi) {
    throw InputError("function.msi_x",
                     "the board sends no messages: expected false, or transfer.notification = "
                     "\"msi\"");
  }
}

void require_shown(const WaveformSettings& waveform, int frames) {
  if (waveform.first_frame < frames) return;
  throw InputError("output.waveform.first_frame",
                   "the run ends before frame " + std::to_string(waveform.first_frame) +
                       ": expected less than frames, which is " + std::to_string(frames));
}

// Refuses what the finer levels of the accelerator do not model.
void require_engine(const Scenario& s) {
  const std::string level = vp::name(s.fidelity.accelerator);
  const auto lacks = [&level](const std::string& what, const std::string& with) {
    throw InputError("fidelity.accelerator", "\"" + level + "\" has no model of " + what +
                                                 ": expected loosely-timed or untimed with " +
                                                 with);
  };
  if (s.accelerator.matrix_storage == accel::MatrixStorage::symmetric) {
    lacks("symmetric storage", "accelerator.matrix_storage = \"symmetric\"");
  }
  if (s.solver.method == fixed::Method::chronopoulos_gear ||
      s.solver.method == fixed::Method::pipelined_cg) {
    lacks("chronopoulos-gear and pipelined-cg", "this solver.method");
  }
  if (s.fidelity.accelerator != vp::Timing::rtl) return;
  vp::require_rtl();
  within("accelerator", [&] { vp::require_rtl(s.accelerator); });
  within("solver", [&] { vp::require_rtl(s.solver); });
  within("accelerator", [&] { vp::require_rtl(s.accelerator, s.solver); });
}

// Refuses transfer settings without a board, as nothing is transferred then.
void require_plain_transfer(const Scenario& s) {
  if (s.transfer.plain()) return;
  const bool moves = s.transfer.method != vp::Transfer::Method::bursts;
  const bool tells = s.transfer.notification != link::Notification::intx;
  throw InputError(
      moves   ? "transfer.method"
      : tells ? "transfer.notification"
              : "transfer.packed",
      std::string("there is no board where host.solver is \"") + host::name(s.host.solver) + "\"");
}

void require_within(const Scenario& s, const vp::Fault& fault) {
  if (fault.frame >= s.frames) {
    throw InputError("frame", "the run ends before frame " + std::to_string(fault.frame) +
                                  ": expected less than frames, which is " +
                                  std::to_string(s.frames));
  }
  if (fault.count > s.frames - std::max<std::int64_t>(fault.frame, 0)) {
    throw InputError("count", "the run has " + std::to_string(s.frames) +
                                  " frames: expected no more from frame " +
                                  std::to_string(fault.frame) + " on");
  }
}

// Refuses flips with which both engines of the level rtl are not held together (docs/rtl.md).
void require_compared(const Scenario& s, const vp::engine::Flip& flip) {
  if (s.fidelity.accelerator != vp::Timing::rtl) return;
  using Place = vp::engine::FlipPlace;
  const accel::Architecture& a = s.accelerator;
  const int nodes = a.package % 3 == 0 ? a.package / 3 : (a.package + 1) / 3 + 1;
  const bool turns = a.direction_memory != accel::DirectionMemory::double_pumped ||
                     a.direction_banks > 1 || a.rows_in_parallel < 3 ||
                     nodes > a.direction_accesses();
  if (turns && (flip.place == Place::nodes || flip.place == Place::phase)) {
    throw InputError("place", std::string(name(flip.place)) +
                                  " is not compared at the level rtl where packages take turns at "
                                  "the memories of d: expected another place, or "
                                  "fidelity.accelerator = \"cycle-accurate\"");
  }
  if (flip.place == Place::r_exponent || flip.place == Place::d_exponent) {
    throw InputError("place", std::string(name(flip.place)) +
                                  " is not compared at the level rtl: expected another place, or "
                                  "fidelity.accelerator = \"cycle-accurate\"");
  }
  if (s.solver.preconditioned() && a.phase_clocks() > vp::engine::kLongestPass) {
    throw InputError("kind", "flip is not compared at the level rtl with a preconditioner and " +
                                 std::to_string(a.phase_clocks()) +
                                 " clocks of a pass: expected accelerator.pipeline_clocks of at "
                                 "most " +
                                 std::to_string(vp::engine::kLongestPass) +
                                 ", or fidelity.accelerator = \"cycle-accurate\"");
  }
}

// Refuses bits that no engine of this architecture has; what depends on the mesh is found when the
// fault strikes.
void require_flip(const Scenario& s, const vp::engine::Flip& flip) {
  if (s.fidelity.accelerator != vp::Timing::cycle_accurate &&
      s.fidelity.accelerator != vp::Timing::rtl) {
    throw InputError("kind", std::string("flip needs memories and registers, which \"") +
                                 vp::name(s.fidelity.accelerator) +
                                 "\" does not have: expected fidelity.accelerator = "
                                 "\"cycle-accurate\" or \"rtl\"");
  }
  const auto below = [](const char* key, int found, int limit) {
    if (found < limit) return;
    throw InputError(key, std::to_string(found) + ": expected less than " + std::to_string(limit));
  };
  require_compared(s, flip);
  using Place = vp::engine::FlipPlace;
  if ((flip.place == Place::z || flip.place == Place::inverse) && !s.solver.preconditioned()) {
    throw InputError("place", std::string(name(flip.place)) +
                                  " is of a preconditioner: expected solver.method = "
                                  "\"jacobi-pcg\" or \"block-jacobi-pcg\"");
  }
  below("partition", flip.partition, s.accelerator.partitions);
  below("copy", flip.copy,
        s.accelerator.direction_memory == accel::DirectionMemory::two_copies ? 2 : 1);
  const int package = s.accelerator.package;
  below("column", flip.column,
        flip.place != Place::nodes ? package
                                   : (package % 3 == 0 ? package / 3 : (package + 1) / 3 + 1));
  switch (flip.place) {
    case Place::x:
    case Place::previous:
    case Place::d:
      return below("bit", flip.bit, s.solver.vector_bits);
    case Place::r:
    case Place::b:
      return below("bit", flip.bit, s.solver.residual_bits());
    case Place::q:
    case Place::z:
      return below("bit", flip.bit, fixed::Settings::kProductBits);
    case Place::inverse:
      return below("bit", flip.bit, fixed::Settings::kProductBits - 1);
    case Place::matrix:
      return below("bit", flip.bit, s.solver.matrix_bits);
    case Place::nodes:
    case Place::owner:
      return below("bit", flip.bit, 20);  // of as many nodes as a scenario may name
    case Place::phase:
      return below("bit", flip.bit, 2);
    case Place::last:
      return below("bit", flip.bit, 1);
    case Place::coefficient:
      return below("bit", flip.bit, s.solver.coefficient_bits - 1);
    case Place::r_r:
      return below("bit", flip.bit, s.solver.scalar_bits);
    case Place::loops:
      return below("bit", flip.bit, vp::engine::kLoopBits);
    case Place::r_exponent:
    case Place::d_exponent:
      return below("bit", flip.bit, vp::engine::kExponentBits);
  }
}

}  // namespace

void require_possible(const Scenario& s, const vp::Fault& fault) {
  using Kind = vp::FaultKind;
  const bool dma = s.transfer.method == vp::Transfer::Method::dma;
  const auto refuse = [&](const std::string& needs, const char* name = "kind") {
    throw InputError(name, std::string(vp::name(fault.kind)) + " needs " + needs);
  };
  if (fault.kind == Kind::saturated_solve && s.fidelity.numbers == vp::Numbers::none) {
    refuse("words that saturate: expected fidelity.numbers = \"fixed\"");
  }
  if ((fault.kind == Kind::late_dma || fault.kind == Kind::truncated_dma) && !dma) {
    refuse("a DMA engine: expected transfer.method = \"dma\"");
  }
  if ((fault.kind == Kind::aer_correctable || fault.kind == Kind::aer_uncorrectable) &&
      (!s.function || !s.function->pci_express)) {
    refuse("a function on PCI Express: expected function.pci_express = true");
  }
  if (fault.kind == Kind::lost_interrupt &&
      s.transfer.notification == link::Notification::polling) {
    refuse("interrupts: expected another transfer.notification than \"polling\"");
  }
  if (fault.kind == Kind::flip) {
    require_flip(s, fault.flip);
    // What the engine at the port has done with a bit that flipped, no replay does.
    if (s.output.engine_port && fault.frame < s.output.engine_port->frames) {
      refuse("frames that output.engine_port does not record: expected a frame from " +
             std::to_string(s.output.engine_port->frames) + " on, or no such record");
    }
  }
  // A DMA engine's fetch of the matrix' values has faults of its own (vp/fpga/dma_values.cpp).
  const bool of_matrix = fault.access == vp::FaultAccess::values;
  const bool blocks = (fault.kind == Kind::corrupted_word && !of_matrix) ||
                      fault.access == vp::FaultAccess::rhs ||
                      fault.access == vp::FaultAccess::solution;
  if (blocks && dma) {
    refuse("b and U as the processor's blocks: expected another transfer.method than \"dma\"",
           fault.kind == Kind::corrupted_word ? "kind" : "access");
  }
  if (fault.access == vp::FaultAccess::values && !s.object.renewal().present()) {
    refuse("values that are written in a frame: expected object.model.matrix.renew_every above 0",
           "access");
  }
  if (fault.access == vp::FaultAccess::status &&
      s.transfer.notification == link::Notification::polling) {
    refuse(
        "one access to STATUS that a frame hangs on: expected another transfer.notification than "
        "\"polling\"",
        "access");
  }
  const bool looks =
      fault.access == vp::FaultAccess::status || fault.access == vp::FaultAccess::acknowledge;
  if (looks && dma && s.transfer.notification != link::Notification::intx) {
    refuse(
        "an access that the driver makes: with a record in memory it looks at STATUS and "
        "acknowledges only for transfer.notification = \"intx\"",
        "access");
  }
}

namespace {

// Refuses settings of a timing-only run whose times would depend on numbers.
void require_no_numbers(const Scenario& s) {
  if (s.host.solver != host::SolvedBy::board) {
    throw InputError(
        "host.solver",
        std::string("how long the host's own solve takes depends on its numbers, which "
                    "fidelity.numbers = \"none\" does not compute: expected \"board\", "
                    "found \"") +
            host::name(s.host.solver) + "\"");
  }
  if (vp::engine_has_words(s.fidelity.accelerator)) {
    throw InputError("fidelity.accelerator",
                     "the cycle-accurate engine makes the words that fidelity.numbers = \"none\" "
                     "does without: expected approximately-timed, loosely-timed or untimed");
  }
}

// Refuses a body that nobody solves.
void require_way_to_solve(const Scenario& s) {
  const bool steps = s.host.solver == host::SolvedBy::steps;
  if (s.host.solver == host::SolvedBy::superposition && (s.dynamics || s.object.nonlinear())) {
    throw InputError(
        "host.solver",
        fmt::format("superposition has columns where contact can be, and a body {} loads all its "
                    "nodes in every frame: expected \"inverse\", \"condensed\", \"cholesky\" or "
                    "\"cg\"",
                    s.dynamics ? "with inertia" : "that is not linear"));
  }
  if (steps && !s.dynamics) {
    throw InputError("host.solver", "explicit steps move masses: expected [dynamics] too");
  }
  if (steps && s.dynamics->scheme != fem::Scheme::newmark) {
    throw InputError("dynamics.scheme",
                     "explicit steps are central differences, without a scheme of their own: "
                     "expected none where host.solver is \"explicit\"");
  }
  if (steps && s.contact.search.glides()) {
    throw InputError(
        "contact.kind",
        "a proxy or a patch needs the compliance of a matrix, and explicit steps have none: "
        "expected \"node\" where host.solver is \"explicit\"");
  }
  if (s.object.model && s.object.model->springs && !steps) {
    throw InputError("object.model.kind",
                     "springs have no matrix to solve with: expected host.solver = \"explicit\"");
  }
  if (s.object.elements != fem::Elements::linear && s.object.model && s.object.model->springs) {
    throw InputError("object.elements",
                     "springs run along the edges of linear tetrahedra: expected \"linear\", or "
                     "another object.model.kind");
  }
}

// Refuses to renew a matrix that does not change.
void require_renewable(const Object& object) {
  if (!object.renewal().present() || object.model->kind != tissue::LawKind::linear) return;
  throw InputError("object.model.matrix.renew_every",
                   "the matrix of a linear law does not change: expected 0, or another "
                   "object.model.kind");
}

// Refuses a run that is too long to count. Times are picoseconds in 64 bits, 106 days; a part of
// them is reserved for the set-up and for what is unfinished at the end.
void require_countable(const Scenario& s) {
  constexpr double kLongest = 9e6;  // s
  const double whole = s.frames * s.budget.period_s;
  if (whole <= kLongest) return;
  throw InputError("frames", std::to_string(s.frames) + " frames take " +
                                 std::to_string(std::llround(whole)) +
                                 " s, and times are counted up to 9000000 s: expected at most " +
                                 std::to_string(std::llround(kLongest / s.budget.period_s)));
}

}  // namespace

std::vector<config::Effect> Scenario::effects() const {
  std::vector<config::Effect> all = config::survey_effects(*this).effects();
  for (std::size_t i = 0; i < probes.size(); ++i) {
    for (config::Effect& effect : probes[i].effects()) {
      effect.path = probe_key(i) + "." + effect.path;
      all.push_back(std::move(effect));
    }
  }
  return all;
}

void Scenario::check() const {
  if (budget.states_errors() && !reference) {
    throw InputError(
        budget.displacement_error > 0 ? "budget.displacement_error" : "budget.force_error",
        "nothing is compared without [reference]: expected that table too");
  }
  require_countable(*this);
  config::survey_effects(*this).require_needs();
  if (probes.empty() || probes.size() > kMostProbes) {
    throw InputError("probe", "expected 1 to " + std::to_string(kMostProbes) + " probes, found " +
                                  std::to_string(probes.size()));
  }
  for (std::size_t i = 0; i < probes.size(); ++i) {
    try {
      if (probes[i].hand && !has_mass(i)) {
        throw InputError("hand", "a hand moves a device that has mass: expected [" + device_key(i) +
                                     ".dynamics] too");
      }
      plant::require_reachable(device_of(i), probes[i]);
      plant::make_device(device_of(i), hand_of(i), probes[i]);
    } catch (const InputError& e) {
      if (e.key().starts_with("device.") && !probes[i].device) throw;
      throw InputError(probe_key(i) + "." + e.key(), e.what());
    }
  }
  if (wall) return;
  const bool board = host.solver == host::SolvedBy::board;
  if (!board) require_plain_transfer(*this);
  if (timing_only()) require_no_numbers(*this);
  require_way_to_solve(*this);
  require_renewable(object);
  if (function) require_possible(*function, *this);
  if (board && vp::has_engine(fidelity.accelerator)) require_engine(*this);
  if (host.cores == 1 && fidelity.host == vp::Timing::untimed) {
    throw InputError("host.cores", "the host takes no time where fidelity.host is \"untimed\"");
  }
  for (std::size_t i = 0; i < faults.size(); ++i) {
    within("fault[" + std::to_string(i) + "]", [&] {
      require_within(*this, faults[i]);
      require_possible(*this, faults[i]);
    });
  }
  if (output.waveform) require_shown(*output.waveform, frames);
}

}  // namespace hvp::app
