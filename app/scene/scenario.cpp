#include "app/scene/scenario.h"

#include <limits>
#include <string>
#include <vector>

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
  v.effect(
      "model", model,
      {"a body that is not linear: its elements' forces are formed on the host, and the "
       "matrix at rest serves for the increments; needs [refinement]",
       is_solved ? "the forces of every element on the host, each pass and once after the force"
                 : "the forces of every element or spring on the host, each substep",
       needs});
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
  v.effect(
      "waveform", waveform,
      {"engine.vcd, for GTKWave: what the engine does at every clock of some frames; at the level "
       "rtl also engine.fst, with all signals of the engine in SystemVerilog",
       "no simulated time; a value change file of every clock of some frames",
       {config::need_board(),
        {"fidelity.accelerator",
         {"cycle-accurate", "rtl"},
         "only an accelerator with every clock has some to show"}}});
  v.effect(
      "engine_port", engine_port,
      {"engine-port.txt: what the host does to the port of the engine in SystemVerilog, and what "
       "comes back, for a testbench of one's own",
       "no simulated time; a line for each word that is written to the engine",
       {config::need_board(),
        {"fidelity.accelerator", {"rtl"}, "only the engine in SystemVerilog has such a port"}}});
}

void EnginePortSettings::declare(config::Visitor& v) {
  v.integer("frames", frames, {1, 100'000'000},
            {"how many frames are recorded, from the first", "a load and a solve"});
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
  // A probe's own device with mass gives a shared hand something to hold.
  std::vector<config::Need> mass = {
      {"device.dynamics", {config::kPresent}, "a hand moves a device that has mass"}};
  if (any_has_mass()) mass.clear();
  v.effect("hand", hand,
           {"who holds the device: a spring and a damper between the intended motion, [probe], and "
            "the device, with or without a mass of its own",
            "no module: part of the device's motion", mass});
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
    needs.push_back({"host.solver",
                     {"board", "cg", "cholesky", "inverse", "superposition", "condensed"},
                     "explicit steps solve nothing"});
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

}  // namespace hvp::app
