#include "app/scene/scenario.h"

#include <cmath>
#include <limits>

#include "models/config/effects.h"
#include "models/config/input_error.h"

namespace hvp::app {

using config::Dimension;

void Budget::declare(config::Visitor& v) {
  v.quantity("period", period_s, Dimension::time, config::between(1e-6, 1),
             {"time between two servo ticks; force and load have to fit into it",
              "thesis section 6.2.2: 500 Hz"});
  const config::Note error = {
      "largest error against the true model: 95 % of the frames in contact are within it of their "
      "own size, and every frame of the run's largest; needs [reference]; 0: not judged",
      "absent: what is accurate enough is the user's to say"};
  v.quantity("displacement_error", displacement_error, Dimension::dimensionless,
             config::between(0, 10), error);
  v.quantity("force_error", force_error, Dimension::dimensionless, config::between(0, 10), error);
  v.quantity("gain_margin", gain_margin, Dimension::dimensionless, config::between(1, 1000),
             {"least gain margin of a device's loop, below which the run is flagged "
              "low-gain-margin: the stiffness at which the linear loop is unstable, at the worst "
              "delay of a frame that moves, over that of the contact",
              "the edge itself; control design asks for 2 to 5 (Åström and Murray, Feedback "
              "Systems, section 10.3)"});
}

void Anchor::declare(config::Visitor& v) { v.include(region); }

void Object::declare(config::Visitor& v) {
  v.choice(
      "elements", elements, fem::elements_names(),
      {"the tetrahedra: linear ones with four nodes, or quadratic ones with ten, which bend and "
       "near a Poisson's ratio of one half hardly lock; with mean dilatation they do not "
       "(docs/finite-elements.md)",
       "thesis section 3.4: linear interpolation"});
  mesh.quadratic = elements != fem::Elements::linear;
  v.table("mesh", mesh, {"the body's shape and how finely it is meshed"});
  v.table("material", material, {"what the body is made of"});
  std::vector<config::Need> needs;
  if (is_solved && (!model || nonlinear())) {
    needs.push_back({"refinement",
                     {config::kPresent},
                     "a body that is not linear is solved by increments, which are its passes"});
  }
  if (!model || nonlinear()) {
    needs.push_back({"object.elements",
                     {"linear"},
                     "the forces of a body that is not linear are those of linear tetrahedra"});
  }
  v.effect("model", model,
           {"a body that is not linear: its elements' forces are formed on the host, and the "
            "matrix at rest serves for the increments; needs [refinement]",
            "the forces of every element on the host, each pass and once after the force", needs});
  v.choice("anchored_nodes", anchored_nodes, fem::anchor_treatment_names(),
           {"whether held nodes leave the system or stay as cleared rows",
            "removed: the 500-node mesh then fits the EP2S60, docs/accelerator.md"});
  v.list("anchor", anchors, {"regions whose nodes are held"});
  v.list("region", regions,
         {"parts of the body with a material of their own. An element belongs to the last region "
          "of the list that has its centroid, otherwise to the body"},
         material);
}

void Object::check() const {
  if (anchors.empty()) {
    throw InputError("anchor",
                     "the body has no anchor and can move freely: expected at least one "
                     "[[object.anchor]]");
  }
  fem::check_names(regions);
}

void Contact::declare(config::Visitor& v) {
  v.include(search);
  v.choice("diagonal", diagonal, fem::contact_diagonal_names(),
           {"what stands on the diagonal of the contact node's rows",
            "thesis section 3.7, footnote: the average conditions better"});
}

void Output::declare(config::Visitor& v) {
  v.integer("deformation_every_frames", deformation_every_frames, {0, 1'000'000},
            {"a .vtu step every so many frames; 0: none", "20 pictures a second at 500 Hz"});
  v.integer("trace_frames", trace_frames, {0, 1'000'000},
            {"how many frames trace.json shows, from the first", "about 6 kB a frame: 6 MB"});
  v.quantity("trace_size", trace_bytes, Dimension::data_size, config::between(10e3, 100e9),
             {"how large trace.json becomes at most; a frame that would exceed it ends the trace, "
              "and the report says so",
              "ten times what the default frames take"});
  v.boolean("pictures", pictures,
            {"draw deformation.png, latency.png and, of a closed loop, loop.png at the end",
             "a run that is looked at"});
  v.boolean("remedies", remedies,
            {"of a run with flags, try what would take them away: some seconds of processor time",
             "a run that is looked at"});
  v.effect("waveform", waveform,
           {"engine.vcd, for GTKWave: what the engine does at every clock of some frames",
            "no simulated time; a value change file of every clock of some frames",
            {config::need_board(),
             {"fidelity.accelerator",
              {"cycle-accurate"},
              "only a cycle-accurate accelerator has clocks to show"}}});
}

void WaveformSettings::declare(config::Visitor& v) {
  v.integer("first_frame", first_frame, {0, 100'000'000},
            {"the first frame that is shown", "the run's first"});
  v.integer("frames", frames, {1, 100'000'000},
            {"how many frames are shown", "a solve of 500 nodes is about 260 bytes a clock"});
}

namespace {

std::string kinds_of(const std::vector<vp::Fault>& faults) {
  std::string kinds;
  for (const vp::Fault& fault : faults) {
    kinds += kinds.empty() ? "" : ", ";
    kinds += vp::name(fault.kind);
  }
  return kinds.empty() ? "what goes wrong" : kinds;
}

}  // namespace

namespace {

std::string cost_of_time_step(const Scenario& s) {
  if (s.host.solver == host::SolvedBy::steps) return "explicit time steps in the solve's place";
  const bool newmark = !s.dynamics || s.dynamics->scheme == fem::Scheme::newmark;
  return std::string(newmark ? "Newmark's" : "generalised-α's") +
         " update on the host after the force";
}

}  // namespace

void Scenario::declare(config::Visitor& v) {
  v.text("title", title, {"one line for the report"});
  v.integer("frames", frames, {1, 100'000'000}, {"servo ticks to simulate", "2 s at 500 Hz"});
  v.integer("seed", seed, {0, std::numeric_limits<std::int64_t>::max()},
            {"chooses the random numbers of every effect that draws some",
             "any will do; the same number gives the same run"});
  v.table("budget", budget, {"what has to hold"});
  v.effect("wall", wall,
           {"a plane with a spring and a damper in the body's place, rendered by the host: what "
            "latency and period do to a loop",
            "no module: the servo process makes the force itself; no board, no collision process"});
  const config::Condition body = config::not_beside(
      "wall", wall.has_value(), "the host renders a wall by itself, without a body or a board");
  object.is_solved = host.solver != host::SolvedBy::steps;
  v.when(body, [&] {
    v.table("object", object, {"the soft body"});
    v.table("loads", loads, {"what acts on the body besides the user"});
    v.effect("dynamics", dynamics,
             {"inertia and damping; without it the body is static",
              "inertia and damping: " + cost_of_time_step(*this)});
    v.table("contact", contact, {"how the probe takes hold of the body"});
    v.table("solver", solver, {"method and words of the fixed-point solver"});
    declare_refinement(v);
    v.table("accelerator", accelerator, {"the FPGA's micro-architecture"});
  });
  v.table("bus", bus, {"the PCI bus"});
  v.when(body, [&] {
    v.table("transfer", transfer, {"how the driver moves a frame's data and hears of the end"});
  });
  v.table("host", host, {"the host PC"}, body);
  v.when(body, [&] {
    v.effect("guest", guest,
             {"how a host that is another program takes its time: with `hvp linux` its system "
              "calls and interrupts take time, an interrupt as long as in `[host]`; nothing with "
              "`hvp run`",
              "with `hvp linux`: a wait before each system call and each interrupt; else nothing "
              "but what `schedule` and `memory_order` ask for",
              {config::need_board("nothing of the board's interrupts the host"),
               config::need_timed_host(), config::need_numbers()}});
  });
  v.table("device", device, {"the haptic device"});
  v.effect("hand", hand,
           {"who holds the device: a spring and a damper between the intended motion, [probe], and "
            "the device, with or without a mass of its own",
            "no module: part of the device's motion",
            {config::Need{
                "device.dynamics", {config::kPresent}, "a hand moves a device that has mass"}}});
  v.one_or_more("probe", probes, {"the probe's prescribed motion; [[probe]] for each of several"});
  v.when(body, [&] {
    v.effect("reference", reference,
             {"solves the same frames in double precision and says how accurate the run was",
              "no simulated time; two double-precision solves beside the board's",
              {config::need_numbers()}});
    v.effect("spectrum", spectrum,
             {"bounds the extreme eigenvalues and the condition number before the run",
              "no simulated time; about six factorisations before the run"});
  });
  v.table("fidelity", fidelity, {"how finely each part is modelled"}, body);
  v.when(body, [&] {
    v.effect("function", function,
             {"for hosts that see a configuration space (`hvp serve`, `hvp linux`, the C library): "
              "what the board's PCI function has beyond the least",
              "where a host sees a configuration space, more of it; no module, no simulated time",
              {config::need_board()}});
    v.effects("fault", faults,
              {"what goes wrong, and in which frame or how often",
               "no module: on the way between bus, board and host, " + kinds_of(faults),
               {config::need_board()}});
  });
  v.table("output", output, {"which results are written besides the summary"});
}

void Scenario::declare_refinement(config::Visitor& v) {
  std::vector<config::Need> needs = {config::need_numbers()};
  // A body that is not linear is solved by increments whoever solves.
  if (host.solver == host::SolvedBy::steps) {
    needs.push_back({"host.solver", {"board", "cg", "cholesky"}, "explicit steps solve nothing"});
  } else if (!object.nonlinear()) {
    needs.push_back(config::need_board("the host solves in double precision: nothing to refine"));
  }
  needs.push_back({"host.pipeline_depth", {"0"}, "each of its passes needs the one before"});
  v.effect("refinement", refinement,
           {"the host forms the residual in double precision and the solver, usually the board, "
            "solves for the increment, in several passes a frame",
            (refinement ? std::to_string(refinement->passes) +
                              " solves a frame, each for what the last left, and a product"
                        : std::string("a solve a pass, and a product")) +
                " with the matrix on the host for each",
            needs});
}

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
  // The matrix' values are the processor's blocks also where a DMA engine moves b and U.
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
  if (s.fidelity.accelerator == vp::Timing::cycle_accurate) {
    throw InputError("fidelity.accelerator",
                     "the cycle-accurate engine makes the words that fidelity.numbers = \"none\" "
                     "does without: expected approximately-timed, loosely-timed or untimed");
  }
}

// Refuses a body that nobody solves.
void require_way_to_solve(const Scenario& s) {
  const bool steps = s.host.solver == host::SolvedBy::steps;
  if (steps && !s.dynamics) {
    throw InputError("host.solver", "explicit steps move masses: expected [dynamics] too");
  }
  if (steps && s.dynamics->scheme != fem::Scheme::newmark) {
    throw InputError("dynamics.scheme",
                     "explicit steps are central differences, without a scheme of their own: "
                     "expected none where host.solver is \"explicit\"");
  }
  if (s.object.model && s.object.model->springs && !steps) {
    throw InputError("object.model.kind",
                     "springs have no matrix to solve with: expected host.solver = \"explicit\"");
  }
  if (s.object.elements == fem::Elements::linear) return;
  if (steps) {
    throw InputError("host.solver",
                     "explicit steps take the forces of linear tetrahedra: expected "
                     "object.elements = \"linear\", or board, cg or cholesky");
  }
  if (s.reference &&
      s.reference->model.value_or(tissue::LawKind::linear) != tissue::LawKind::linear) {
    throw InputError("reference.model",
                     "a body that is not linear has the forces of linear tetrahedra: expected "
                     "\"linear\", or object.elements = \"linear\"");
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
      plant::require_reachable(device, probes[i]);
      plant::make_device(device, hand, probes[i]);
    } catch (const InputError& e) {
      if (e.key().starts_with("device.")) throw;
      const std::string item = probes.size() > 1 ? "[" + std::to_string(i) + "]" : "";
      throw InputError("probe" + item + "." + e.key(), e.what());
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
