#include "app/run/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "app/remedy/replay.h"
#include "app/results/board_records.h"
#include "app/results/frames_csv.h"
#include "app/results/host_solve.h"
#include "app/results/outcome.h"
#include "app/results/part_files.h"
#include "app/results/results_folder.h"
#include "app/results/trace.h"
#include "app/run/accuracy.h"
#include "app/run/deformation_recorder.h"
#include "app/run/watches.h"
#include "app/scene/unit_contacts.h"
#include "driver/hvp_driver.h"
#include "vp/bus/bus_meter.h"
#include "vp/fpga/accelerator.h"
#include "vp/frame/latency_statistics.h"
#include "vp/platform.h"

namespace hvp::app {

namespace {

// Reports the progress of a long run.
class ProgressTicker : public vp::FrameObserver {
 public:
  ProgressTicker(const Progress& progress, std::int64_t frames)
      : progress_(progress), frames_(frames) {}

  void solved(const vp::Frame& frame, const vp::Solution& /*solution*/) override {
    const std::int64_t percent = 100 * (frame.number + 1) / frames_;
    const auto now = std::chrono::steady_clock::now();
    if (percent == last_ && now - shown_ < kLongest) return;
    last_ = percent;
    shown_ = now;
    progress_(fmt::format("simulating: frame {} of {} ({} %)", frame.number + 1, frames_, percent));
  }

 private:
  // A frame whose truth is hard to find takes a second.
  static constexpr std::chrono::milliseconds kLongest{500};

  const Progress& progress_;
  std::int64_t frames_;
  std::int64_t last_ = -1;
  std::chrono::steady_clock::time_point shown_;
};

// Meters of the PCI bus and, where there is a link, of each of its directions.
class BusMeters {
 public:
  explicit BusMeters(vp::Platform& platform)
      : bus_({[&platform] { return platform.bus().busy(); },
              [&platform] { return platform.bus().busy_until_now(); },
              [&platform] { return platform.bus().uses(); },
              [&platform] { return platform.bus().uses_until_now(); }}) {
    platform.add_observer(bus_);
    if (platform.pcie() == nullptr) return;
    const auto direction = [&platform](link::PcieSide sender) {
      const auto busy = [&platform, sender] { return platform.pcie()->busy(sender); };
      const auto uses = [&platform] { return platform.pcie()->uses(); };
      return vp::BusMeter::Bus{busy, busy, uses, uses};
    };
    to_board_.emplace(direction(link::PcieSide::root));
    to_host_.emplace(direction(link::PcieSide::device));
    platform.add_observer(*to_board_);
    platform.add_observer(*to_host_);
  }

  void ended() {
    bus_.ended();
    if (to_board_) to_board_->ended();
    if (to_host_) to_host_->ended();
  }

  void fill(results::BusFigures& figures) const {
    figures.load = load(bus_);
    if (to_board_) figures.link = {load(*to_board_), load(*to_host_)};
  }

 private:
  static results::BusLoad load(const vp::BusMeter& meter) {
    return {meter.share(), meter.worst_share(), meter.time(), meter.uses()};
  }

  vp::BusMeter bus_;
  std::optional<vp::BusMeter> to_board_;
  std::optional<vp::BusMeter> to_host_;
};

// The observers in every run that computes numbers.
class BodyWatches {
 public:
  BodyWatches(vp::Platform& platform, Scene& scene)
      : force_(scene.contacts(), scene.glide() != nullptr ? &scene.glide()->surface : nullptr,
               scene.scenario().probes.size()),
        strain_(scene.body(), scene.scenario().object.model),
        recorder_(scene.scenario().frames) {
    platform.add_observer(recorder_);
    platform.add_observer(force_);
    platform.add_observer(strain_);
  }

  void fill(results::Outcome& outcome) const {
    outcome.force = force_.qualities().front();
    if (force_.qualities().size() > 1) outcome.forces = force_.qualities();
    outcome.strain = {strain_.worst(), strain_.worst_frame()};
    for (const auto& quality : force_.qualities()) outcome.flags.merge(quality.flags());
    outcome.flags.merge(strain_.flags());
  }

  const Recorder& recorder() const { return recorder_; }

 private:
  ForceWatch force_;
  StrainWatch strain_;
  Recorder recorder_;
};

// The budgets that the scenario states, with the measured values.
std::vector<results::ErrorBudget> error_budgets(const Budget& budget,
                                                const std::optional<results::Accuracy>& accuracy) {
  std::vector<results::ErrorBudget> budgets;
  const results::Accuracy a = accuracy.value_or(results::Accuracy{});
  const auto state = [&](std::string_view of, double limit,
                         const results::Accuracy::Quantity& measured) {
    if (limit == 0) return;
    results::ErrorBudget b{.of = of, .limit = limit};
    b.compared = a.compared;
    b.in_contact = a.in_contact;
    if (a.speaks_for_all(measured) && measured.worst) {
      b.p95 = measured.of_frame->p95;
      b.worst = *measured.worst;
      b.measured = true;
    }
    budgets.push_back(b);
  };
  state("displacement", budget.displacement_error, a.displacement);
  state("force", budget.force_error, a.force);
  return budgets;
}

results::ProbeColumns probe_columns_of(const Scenario& s) {
  results::ProbeColumns columns{{},
                                s.wall,
                                s.host.virtual_coupling.has_value(),
                                s.host.passivity.has_value(),
                                !s.wall && s.contact.search.kind == collision::ContactKind::proxy,
                                std::ranges::any_of(s.faults, [](const vp::Fault& fault) {
                                  return fault.kind == vp::FaultKind::flip;
                                })};
  for (std::size_t i = 0; i < s.probes.size(); ++i) {
    const plant::DeviceSettings& device = s.device_of(i);
    columns.probes.push_back({s.probes[i], s.has_mass(i), s.has_mass(i) && device.motor,
                              s.hand_of(i), s.has_mass(i) && device.structure});
  }
  return columns;
}

std::optional<vp::SoftBody> body_of(Scene& scene) {
  if (!scene.has_body()) return std::nullopt;
  return soft_body(scene);
}

// The stiffness that the device is pressed against, where it is known within a run's set-up, N/m.
std::optional<double> known_contact_stiffness(const Scene& scene) {
  const Scenario& s = scene.scenario();
  // That of the body at rest, which a body that is not linear has nowhere else.
  if (!s.wall && (s.object.nonlinear() || !quick_to_factorise(scene))) return std::nullopt;
  const std::optional<double> contact =
      s.wall ? std::optional(s.wall->stiffness_N_m) : contact_stiffness(scene);
  if (!contact || !s.host.virtual_coupling) return contact;
  return s.host.virtual_coupling->in_series(*contact);
}

// The flags that were raised before the first frame, or follow from counts.
stability::Flags scene_flags(const Scene& scene, const vp::ServoCounts& counts) {
  stability::Flags flags(counts.flags);
  if (counts.clamped_words > 0) flags.raise(stability::Flag::range_exceeded);
  if (counts.clamped_forces > 0) flags.raise(stability::Flag::force_clamped);
  if (scene.has_board() && scene.spectrum() && !scene.spectrum()->rounded.positive_definite()) {
    flags.raise(stability::Flag::negative_curvature);
  }
  if (scene.locking()) flags.raise(stability::Flag::locking);
  if (scene.has_body() && scene.quality().slivers > 0) flags.raise(stability::Flag::poor_elements);
  return flags;
}

results::Outcome outcome_of(const vp::Platform& platform, const Scene& scene,
                            const vp::LatencyStatistics& latency, const ContactWatch& contact,
                            const std::optional<results::Accuracy>& accuracy) {
  const Scenario& s = scene.scenario();
  results::Outcome o;
  o.scene = results::scene_figures(scene);
  o.verdict = platform.verdict();
  o.latency = results::latency_figures(o.verdict, latency, s.host);
  o.ticks = platform.servo().ticks();
  o.set_up = platform.servo().set_up_time();
  o.simulated = vp::now_ps() - platform.session().begin;
  o.servo = platform.servo().counts();
  if (const vp::DevicePort* port = platform.servo().port()) {
    o.tools = port->tools();
    o.passivity = port->controllers();
  }
  if (const vp::FaultPlan* faults = platform.faults()) {
    o.faults.assign(faults->records().begin(), faults->records().end());
  }
  o.accelerator = results::accelerator_figures(scene, platform.board());
  if (const vp::Accelerator* board = platform.board()) {
    o.saturations = board->saturations();
    o.wraps = board->wraps();
    o.breakdowns = board->breakdowns();
  }
  o.bus.transactions = platform.bus().transactions();
  o.bus.bytes = platform.bus().bytes_moved();
  o.bus.busy = platform.bus().busy();
  o.contact = contact.figures();
  o.contact.changes = o.servo.contact_changes;
  if (const host::GlideTables* glide = scene.glide()) {
    o.contact.proxy.bytes = static_cast<std::int64_t>(glide->bytes());
    o.contact.proxy.solves = glide->solves();
  }
  if (const vp::CollisionProcess* collision = platform.collision()) {
    o.contact.collision_passes = collision->passes();
    o.contact.longest_pass = collision->longest_pass();
  }
  o.accuracy = accuracy;
  o.error_budgets = error_budgets(s.budget, accuracy);
  if (scene.has_body()) {
    if (const host::Increments* increments = scene.computation().increments()) {
      const host::RefinedSolve* refined = scene.computation().refined();
      o.refinement = {s.refinement->passes, increments->worst_remaining(),
                      refined != nullptr ? refined->widened() : 0, increments->without_start(),
                      contact.first_without_start()};
    }
    if (const host::RenewalCounts* renewals = scene.computation().renewals()) {
      o.matrix = {*renewals};
    }
  }
  if (scene.has_body()) {
    if (const fem::ExplicitSteps* steps = scene.computation().explicit_steps()) {
      o.explicit_steps = {steps->substeps(), steps->substep_s(), steps->limit_at_rest_s(),
                          steps->least_limit_s()};
    }
    o.host_solve = results::host_solve_figures(scene);
  }
  o.flags = scene_flags(scene, o.servo);
  return o;
}

// The engine in SystemVerilog is not that of its description.
class EngineDifference : public std::runtime_error {
 public:
  EngineDifference(const vp::Accelerator& board, bool shown)
      : std::runtime_error(fmt::format(
            "{}, in frame {}; {}", board.difference(), board.frame(),
            shown ? "engine.vcd and engine.fst have what was asked for of the frames up to it"
                  : fmt::format("with --set output.waveform.first_frame={} engine.vcd and "
                                "engine.fst show both",
                                board.frame()))) {}
};

results::Outcome simulate(Scene& scene, const RunOptions& options) {
  const Scenario& s = scene.scenario();
  const std::filesystem::path& directory = options.directory;
  results::write_resolved_scenario(directory, s, options.device);

  std::optional<results::RegisterTrace> registers;
  if (options.trace_registers) registers.emplace(directory);
  std::optional<AccuracyTracker> accuracy;
  if (s.reference) accuracy.emplace(scene, *s.reference);
  std::optional<DeformationRecorder> deformation;
  if (s.output.deformation_every_frames > 0 && !s.timing_only() && scene.has_body()) {
    deformation.emplace(directory, scene);
  }

  if (options.progress) options.progress("looking at the rounded matrix");
  const std::optional<host::RoundingEstimate> rounding = estimate_rounding(scene);

  std::optional<results::WaveformFile> waveform;
  if (s.output.waveform) waveform.emplace(directory, "engine");
  std::optional<results::WaveformFile> rtl_waveform;
  if (s.output.waveform && s.fidelity.accelerator == vp::Timing::rtl) {
    rtl_waveform.emplace(directory, "engine", results::WaveformFormat::fst);
  }
  vp::PlatformSettings settings =
      platform_settings(scene, waveform ? waveform->tracer_file() : std::string());
  std::optional<results::PartStream> port;
  std::int64_t port_lines = 0;
  if (s.output.engine_port) {
    port.emplace(directory / "engine-port.txt");
    settings.engine_port = {
        [&](char what, std::uint32_t first, std::uint32_t second, std::uint32_t third) {
          port->write(fmt::format("{} {:x} {:x} {:x}\n", what, first, second, third));
          ++port_lines;
        },
        s.output.engine_port->frames};
  }
  vp::Platform platform(settings, body_of(scene), registers ? &*registers : nullptr);
  if (registers && platform.board() != nullptr) registers->watch(*platform.board());
  std::optional<results::JobRecord> jobs;
  if (options.record_jobs) {
    platform.observe_jobs(jobs.emplace(directory, platform.verdict().period()));
  }
  results::FramesCsv frames(directory / "frames.csv", platform.verdict().budget(),
                            s.timing_only() ? results::Columns::times : results::Columns::all,
                            probe_columns_of(s));
  results::TraceSettings traced{s.output.trace_frames, std::llround(s.output.trace_bytes),
                                platform.verdict().budget()};
  if (s.output.trace_frames < s.frames) {
    traced.end = s.output.trace_frames * platform.verdict().period();
  }
  results::Trace trace(directory / "trace.json", platform.session(), traced);
  std::optional<results::DmaLog> dma_log;
  if (options.trace_dma) {
    vp::DmaEngine* const dma = platform.board() != nullptr ? platform.board()->dma() : nullptr;
    results::trace_dma(dma, trace, registers ? std::filesystem::path() : directory, dma_log);
  }
  vp::LatencyStatistics latency;
  platform.add_observer(latency);
  std::optional<vp::LateProbability> late;
  if (vp::LateProbability::applies(s.host)) {
    platform.add_observer(late.emplace(s.host, platform.verdict().budget()));
  }
  platform.add_observer(frames);
  platform.add_observer(trace);
  if (s.output.trace_frames > 0) platform.add_tenure_sink(trace);
  if (accuracy) platform.add_observer(*accuracy);
  if (deformation) platform.add_observer(*deformation);
  const std::unique_ptr<ContactWatch> contact =
      scene.has_body()
          ? std::make_unique<ApproachWatch>(scene.contacts())
          : std::make_unique<ContactWatch>(s.wall && s.wall->sides == host::Wall::Sides::both);
  platform.add_observer(*contact);
  std::optional<BodyWatches> body;
  if (!s.timing_only() && scene.has_body()) body.emplace(platform, scene);
  std::optional<LoopWatch> loop;
  if (s.any_has_mass()) {
    loop.emplace(s);
    platform.add_observer(*loop);
  }
  BusMeters buses(platform);
  ProgressTicker ticker(options.progress, s.frames);
  if (options.progress) platform.add_observer(ticker);

  platform.stop_when([] { return results::interrupted() != 0; });

  try {
    platform.run();
  } catch (...) {
    if (platform.board() == nullptr || platform.board()->difference().empty()) throw;
    // Where the engines part is what one looks at then.
    platform.close_waveform();
    if (waveform) waveform->finish();
    if (rtl_waveform) rtl_waveform->finish();
    throw EngineDifference(*platform.board(), waveform.has_value());
  }
  buses.ended();
  if (platform.servo().ticks() == 0 && results::interrupted() != 0) throw Interrupted();
  if (platform.verdict().frames() == 0) {
    throw std::runtime_error(fmt::format("the board could not be set up: {}",
                                         hvp_status_text(platform.servo().counts().last_error)));
  }

  frames.finish();
  trace.finish();
  if (registers) registers->finish();
  if (dma_log) dma_log->finish();
  if (jobs) {
    jobs->finish();
    if (jobs->ended_early()) {
      spdlog::warn("jobs.hvpf has the first {} jobs: {}", jobs->jobs(), *jobs->ended_early());
    }
  }
  if (deformation) deformation->finish();
  platform.close_waveform();
  if (waveform) waveform->finish();
  if (port) {
    // A testbench knows by it that nothing of the record is missing.
    port->write(fmt::format("z {:x} 0 0\n", port_lines));
    port->finish();
  }
  if (rtl_waveform) rtl_waveform->finish();
  results::Outcome outcome =
      outcome_of(platform, scene, latency, *contact,
                 accuracy ? std::optional(accuracy->accuracy()) : std::nullopt);
  if (late) outcome.late_probability = late->result();
  buses.fill(outcome.bus);
  if (body) body->fill(outcome);
  outcome.flags.merge(contact->flags());
  if (loop) {
    // For timing only no force is computed, and none moves the device.
    if (!s.timing_only()) {
      outcome.loop = loop->qualities();
      outcome.flags.merge(loop->flags());
    }
    outcome.take_stiffnesses(loop->stiffnesses(known_contact_stiffness(scene)));
    outcome.flags.merge(results::margin_flags(outcome.stiffness, s.budget.gain_margin));
  }
  outcome.rounding = rounding;
  if (rounding) {
    outcome.flags.merge(
        rounding->flags(scene.scenario().refinement.has_value(), outcome.accuracy_measured()));
  }
  outcome.trace_cut_at = trace.cut_at();
  if (accuracy) outcome.flags.merge(accuracy->flags());
  const auto began = std::chrono::steady_clock::now();
  if (s.output.remedies && !outcome.partial() && !outcome.flags.empty()) {
    outcome.remedy = find_remedy(scene, outcome, body ? &body->recorder() : nullptr, options.again,
                                 options.progress);
  }
  outcome.remedy_search_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  results::write_through_part_file(directory / "summary.json", results::summary_json(outcome));
  return outcome;
}

}  // namespace

results::Outcome run(Scene& scene, const RunOptions& options) {
  results::remove_earlier_results(options.directory);
  try {
    return simulate(scene, options);
  } catch (const EngineDifference&) {
    results::remove_earlier_results(options.directory, {"engine.vcd", "engine.fst"});
    throw;
  } catch (...) {
    results::remove_earlier_results(options.directory);
    throw;
  }
}

}  // namespace hvp::app
