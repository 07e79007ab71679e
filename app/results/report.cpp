#include "app/results/report.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

#include "app/results/faults.h"
#include "app/results/flags.h"
#include "app/results/misses.h"
#include "app/results/number_text.h"
#include "app/results/outcome.h"
#include "app/results/regions.h"
#include "app/scenario/message.h"
#include "app/scene/scene.h"
#include "driver/hvp_driver.h"
#include "models/statistics/histogram.h"

namespace hvp::results {

namespace {

using Out = std::back_insert_iterator<std::string>;

constexpr int kBarWidth = 30;
constexpr double kLeastShareOfFrame = 0.005;  // of the worst frame, for a line of its own

std::string counted_passes(int passes) {
  return fmt::format("{} pass{}", passes, passes == 1 ? "" : "es");
}

// Clocks of the longest solve of the run where an engine counted it, else by the closed form.
std::string solve_clocks(const app::Scene& scene, const Outcome& o) {
  const std::int64_t clocks = o.accelerator->solve_cycles();
  const bool by_engine = o.accelerator->engine.has_value();
  const bool bound =
      !by_engine && scene.scenario().solver.stop_residual > 0 && !scene.scenario().timing_only();
  const accel::Architecture& a = scene.scenario().accelerator;
  return fmt::format("{}{} clocks {} at {:g} MHz = {}", bound ? "at most " : "", clocks,
                     by_engine ? "for the longest solve" : "a solve", a.clock_hz * 1e-6,
                     readable_time(clocks * a.clock_period_ps()));
}

// What stands behind the results of the level rtl.
void compared_line(Out out, const Outcome& o) {
  if (!o.accelerator || !o.accelerator->compared) return;
  const vp::rtl::Compared& c = *o.accelerator->compared;
  if (c.solves == 0 && c.aborted == 0) {
    fmt::format_to(out, "\nRTL          nothing was compared: no frame has a solve\n");
    return;
  }
  fmt::format_to(out,
                 "\nRTL          as the cycle-accurate engine: {}, {} aborted, with {}; {} of the "
                 "matrix;\n             {} and {} compared\n",
                 counted(c.solves, "solve"), c.aborted, counted(c.iterations, "iteration"),
                 counted(c.updates, "update"), counted(c.clocks, "clock"),
                 counted(c.words, "word"));
}

void engine_lines(Out out, const app::Scene& scene, const Outcome& o) {
  if (!o.accelerator || !o.accelerator->engine) return;
  const EngineClocks& e = *o.accelerator->engine;
  fmt::format_to(out, "\nEngine       {}: the longest solve, {}\n",
                 vp::name(scene.scenario().fidelity.accelerator),
                 counted(e.iterations, "iteration"));
  fmt::format_to(out, "  {:<28} {:>9} {:>12}\n", "clocks", "engine", "closed form");
  for (const PhaseClocks& p : e.phases) {
    if (p.engine == 0 && p.closed_form == 0) continue;
    fmt::format_to(out, "  {:<28} {:>9} {:>12}\n", p.title, p.engine, p.closed_form);
  }
  fmt::format_to(out, "  {:<28} {:>9} {:>12}   {:+.2f} %\n", "together", e.engine, e.closed_form,
                 100 * e.deviation());
}

// What locks, with the name of its part where there are several.
std::string locking_text(const app::Scene& scene) {
  const fem::Locking& locking = *scene.locking();
  const std::vector<fem::Region>& regions = scene.scenario().object.regions;
  if (regions.empty()) return locking.sentence;
  const std::size_t m = locking.material;
  return (m == 0 ? std::string(fem::kOfBody) : fem::name_of(regions, m - 1)) + ": " +
         locking.sentence;
}

// What the watch of the run has found; nothing before a run.
std::string least_limit_text(const fem::ExplicitSteps& steps) {
  if (!std::isfinite(steps.least_limit_s())) return {};
  return fmt::format(", in this run below {}",
                     readable_time(to_picoseconds(steps.least_limit_s())));
}

std::string host_solver_text(const app::Scenario& s) {
  switch (s.host.solver) {
    case host::SolvedBy::cholesky:
      return "Cholesky factors of the matrix";
    case host::SolvedBy::inverse:
      return "the matrix' inverse";
    case host::SolvedBy::superposition:
      return "superposition of the inverse's columns";
    case host::SolvedBy::condensed:
      return "the inverse at the surface, factors for the rest";
    case host::SolvedBy::cg:
    case host::SolvedBy::board:
    case host::SolvedBy::steps:
      break;
  }
  return fmt::format("CG, {}{} iterations", s.solver.stop_residual > 0 ? "at most " : "",
                     s.solver.iterations);
}

// With increments the matrix is that of the body at rest, whatever its forces are.
std::string passes_text(const app::Scenario& s) {
  if (!s.refinement) return {};
  return fmt::format(", {} in {}", s.object.nonlinear() ? "increments" : "refined",
                     counted_passes(s.refinement->passes));
}

std::string_view elements_text(fem::Elements elements) {
  switch (elements) {
    case fem::Elements::linear:
      break;
    case fem::Elements::quadratic:
      return "quadratic ";
    case fem::Elements::mean_dilatation:
      return "quadratic mean-dilatation ";
  }
  return "";
}

void scene_lines(Out out, const app::Scene& scene, const Outcome& o) {
  const app::Scenario& s = scene.scenario();
  if (!s.title.empty()) fmt::format_to(out, "{}\n", scenario::one_line(s.title, 1000));
  if (s.wall) {
    fmt::format_to(out, "  wall        {:g} N/m, {:g} N s/m, {}; rendered by the host, no board\n",
                   s.wall->stiffness_N_m, s.wall->damping_N_s_m,
                   s.wall->sides == host::Wall::Sides::one ? "pushes only" : "pushes and pulls");
    return;
  }
  fmt::format_to(
      out, "  body        {} nodes, {} {}tetrahedra; {} nodes in the system, {}{}\n",
      scene.quality().nodes, scene.quality().tetrahedra, elements_text(s.object.elements),
      scene.body().active_nodes(), s.dynamics ? "dynamic" : "static",
      s.object.nonlinear() ? fmt::format(", {}", tissue::name(*s.object.model)) : std::string());
  fmt::format_to(out, "{}{}", regions_text(scene), unit_text(scene));
  if (const fem::ExplicitSteps* steps = scene.computation().explicit_steps()) {
    fmt::format_to(
        out,
        "  solver      none: {} explicit steps of {} a frame on the host, stable at rest "
        "below {}{}\n",
        steps->substeps(), readable_time(to_picoseconds(steps->substep_s())),
        readable_time(to_picoseconds(steps->limit_at_rest_s())), least_limit_text(*steps));
    return;
  }
  if (!scene.has_board()) {
    fmt::format_to(out, "  solver      {}{}, in {} precision on the {}; no board\n",
                   host_solver_text(s), passes_text(s), host::name(s.host.precision),
                   s.host.gpu ? "host's GPU" : "host");
    return;
  }
  const char* most = s.solver.stop_residual > 0 && !s.timing_only() ? "at most " : "";
  fmt::format_to(out, "  solver      {}, {}{} iterations, {}-bit matrix, {}-bit vectors{}\n",
                 display_name(s.solver.method), most, s.solver.iterations, s.solver.matrix_bits,
                 s.solver.vector_bits, passes_text(s));
  fmt::format_to(out, "  board       {}: {};", scene.board_name(), solve_clocks(scene, o));
  const char* separator = " ";
  for (const accel::Resource& r : scene.usage().resources) {
    if (r.used == 0) continue;
    fmt::format_to(out, "{}{} {}/{}", separator, r.type, r.used, r.available);
    separator = ", ";
  }
  fmt::format_to(out, "\n");
}

// Lists what the verdict does not cover.
void reservations(Out out, const app::Scene& scene, const Outcome& o) {
  const vp::Fidelity& f = scene.scenario().fidelity;
  std::string parts;
  const auto check = [&parts](std::string_view part, vp::Timing level) {
    if (level != vp::Timing::untimed) return;
    parts += fmt::format("{}{}", parts.empty() ? "" : ", ", part);
  };
  if (scene.has_body()) check("accelerator", f.accelerator);
  check("bus", f.bus);
  check("host", f.host);
  if (!parts.empty()) fmt::format_to(out, "  untimed        {}: takes no time here\n", parts);
  if (scene.scenario().timing_only()) {
    fmt::format_to(
        out,
        "  timing only    nobody computed numbers: {}every solve makes all {} iterations, "
        "the probe\n                 meets the undeformed body\n",
        scene.scenario().solver.stop_residual > 0 ? "stop_residual ends none, " : "",
        scene.scenario().solver.iterations);
  }
  if (o.contact.changes == 0) fmt::format_to(out, "{}", no_contact_text(scene, o.contact));
}

void spread_line(Out out, std::string_view what, const std::optional<Spread>& s) {
  if (!s) return;
  fmt::format_to(out, "  {:<14} median {}, 99 % {}, worst {}\n", what, readable_time(s->p50),
                 readable_time(s->p99), readable_time(s->worst));
}

void verdict_lines(Out out, const Outcome& o) {
  const vp::Verdict& v = o.verdict;
  const std::string_view qualified = o.verdict_word();
  fmt::format_to(out, "\nTime         {} at {:g} Hz\n",
                 counted(v.frames() + v.skipped_ticks(), "tick"),
                 1e12 / static_cast<double>(v.period()));
  if (o.partial()) {
    fmt::format_to(out, "  interrupted    at frame {} of {}: what follows is of those before\n",
                   o.ticks, o.scene.frames);
  }
  fmt::format_to(out, "  force in time  {}: worst {} of {}, median {}, 99 % {}",
                 o.force_in_time() ? qualified : "MISSED", readable_time(v.worst_latency()),
                 readable_time(v.budget()), readable_time(v.percentile(0.50)),
                 readable_time(v.percentile(0.99)));
  fmt::format_to(out, "; {} late, {} skipped", v.late_forces(), v.skipped_ticks());
  if (const std::int64_t held = o.servo.held_frames; held > 0) {
    fmt::format_to(out, ", {} without a solution", held);
  }
  fmt::format_to(out, "{}", misses_text(o));
  fmt::format_to(out, "\n  load           {}: worst {} of {}",
                 v.load_held() ? qualified : "EXCEEDED", readable_time(v.worst_load()),
                 readable_time(v.period()));
  fmt::format_to(out, "; {} over, {} skipped\n", v.overloads() - v.skipped_ticks(),
                 v.skipped_ticks());
  for (const ErrorBudget& b : o.error_budgets) {
    if (!b.measured) {
      fmt::format_to(out, "  {:<14} NOT MEASURED: {} of {} in contact compared{}\n",
                     fmt::format("{} error", b.of), b.compared, counted(b.in_contact, "frame"),
                     b.compared > 0 ? ", too few to speak for 95 % of them" : "");
      continue;
    }
    fmt::format_to(out, "  {:<14} {}: 95 % of {} within {} of {}, worst {} of the largest\n",
                   fmt::format("{} error", b.of), b.held() ? qualified : "EXCEEDED",
                   b.compared == b.in_contact
                       ? counted(b.compared, "frame")
                       : fmt::format("{} compared of {} in contact", counted(b.compared, "frame"),
                                     b.in_contact),
                   percent(b.p95), percent(b.limit), percent(b.worst));
  }
  if (v.lateness().count() > 0) {
    spread_line(out, "late forces by", statistics::spread_of(v.lateness()));
  }
  if (o.latency.change.worst > 0) spread_line(out, "frame to frame", o.latency.change);
  spread_line(out, "release after", o.latency.release);
  spread_line(out, "wake-up after", o.latency.wake_up);
}

void initiators(Out out, const BusLoad& load) {
  const char* separator = "; ";
  for (const vp::BusUse& use : load.uses) {
    if (use.transactions == 0 && use.busy == 0) continue;
    fmt::format_to(out, "{}{} {}", separator, use.name, percent(load.share_of(use)));
    separator = ", ";
  }
  fmt::format_to(out, "\n");
}

void bus_lines(Out out, const Outcome& o) {
  const auto taken = [](const BusLoad& load) {
    return fmt::format("{} of the time, {} around the busiest frame", percent(load.share),
                       percent(load.worst_share));
  };
  fmt::format_to(out, "  bus taken      {}", taken(o.bus.load));
  initiators(out, o.bus.load);
  if (!o.bus.link) return;
  fmt::format_to(out, "  link taken     to the board {}\n", taken(o.bus.link->to_board));
  fmt::format_to(out, "                 to the host {}", taken(o.bus.link->to_host));
  initiators(out, o.bus.link->to_board);
}

void attribution_lines(Out out, const Outcome& o) {
  fmt::format_to(out, "\nWorst frame  number {}: {} from its tick to the force at the motor\n",
                 o.verdict.worst_frame(), readable_time(o.verdict.worst_latency()));
  std::vector<vp::Attribution> lines = o.verdict.attribution();
  std::stable_sort(lines.begin(), lines.end(),
                   [](const auto& a, const auto& b) { return a.time > b.time; });
  const auto line = [&](const std::string& what, vp::Picoseconds time) {
    const double share = static_cast<double>(time) / static_cast<double>(o.verdict.worst_latency());
    const auto bar = static_cast<std::size_t>(std::lround(share * kBarWidth));
    fmt::format_to(out, "  {:<22} {:>10}  {:>5.1f} %{}\n", what, readable_time(time), 100 * share,
                   bar == 0 ? "" : "  " + std::string(bar, '#'));
  };
  vp::Picoseconds rest = 0;
  int rests = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const vp::Attribution& a = lines[i];
    if (a.time == 0) continue;
    // The report fits a screen, and summary.json has every phase. A single line is not folded.
    const bool more = i + 1 < lines.size() && lines[i + 1].time > 0;
    if (static_cast<double>(a.time) <
            kLeastShareOfFrame * static_cast<double>(o.verdict.worst_latency()) &&
        (rests > 0 || more)) {
      rest += a.time;
      ++rests;
    } else {
      line(fmt::format("{} {}", name(a.part), name(a.phase)), a.time);
    }
  }
  if (rests > 0) line(fmt::format("other, {} phases", rests), rest);
}

void stability_lines(Out out, const app::Scene& scene, const Outcome& o) {
  if (!scene.has_body()) {
    fmt::format_to(out, "\nStability    a wall has no solver\n");
  } else if (scene.scenario().timing_only()) {
    fmt::format_to(out, "\nStability    timing only: there are no words that could saturate\n");
  } else {
    fmt::format_to(out, "\nStability    {}, {}, {}\n", counted(o.saturations, "saturation"),
                   counted(o.breakdowns, "breakdown"),
                   counted(o.servo.clamped_words, "clamped word"));
  }
  if (o.wraps > 0) fmt::format_to(out, "  {}\n", counted(o.wraps, "wrapped word"));
  if (o.servo.clamped_forces > 0) {
    fmt::format_to(out, "  {} with a force that the device's register clamped\n",
                   counted(o.servo.clamped_forces, "frame"));
  }
  if (o.servo.held_frames > 0) {
    fmt::format_to(out,
                   "  {} without a solution: the force of the last solved frame was held\n"
                   "    the driver: {}\n",
                   counted(o.servo.held_frames, "frame"), hvp_status_text(o.servo.last_error));
  }
  if (o.refinement && o.refinement->without_start > 0) {
    fmt::format_to(out,
                   "  {} kept the last solution, the first in frame {}: with the "
                   "contact in its place the body had no forces\n",
                   counted(o.refinement->without_start, "frame"),
                   o.refinement->first_without_start);
  }
  for (unsigned i = 0; i < static_cast<unsigned>(stability::Flag::count); ++i) {
    const auto flag = static_cast<stability::Flag>(i);
    if (!o.flags.has(flag)) continue;
    const stability::Description& d = stability::describe(flag);
    fmt::format_to(out, "  FLAG {}: {}\n", d.name, d.meaning);
    if (o.remedy && !o.remedy->settings.empty() && o.remedy->taken_away().has(flag)) continue;
    fmt::format_to(out, "    remedy: {}\n", d.remedy);
  }
  if (o.remedy) fmt::format_to(out, "{}", remedy_text(*o.remedy));
  if (scene.locking()) fmt::format_to(out, "    {}\n", locking_text(scene));
  if (o.flags.empty()) fmt::format_to(out, "  no flags\n");
}

void spectrum_lines(Out out, const app::Scene& scene) {
  if (!scene.spectrum()) return;
  fmt::format_to(out, "\nSpectrum     of the system without contact\n{}",
                 spectrum_text(*scene.spectrum()));
}

}  // namespace

std::string_view display_name(fixed::Method method) {
  switch (method) {
    case fixed::Method::cg:
      return "CG";
    case fixed::Method::jacobi_pcg:
      return "Jacobi-PCG";
    case fixed::Method::block_jacobi_pcg:
      return "block-Jacobi-PCG";
    case fixed::Method::chronopoulos_gear:
      return "Chronopoulos-Gear CG";
    case fixed::Method::pipelined_cg:
      return "pipelined CG";
  }
  return "";
}

std::string report(const app::Scene& scene, const Outcome& o) {
  std::string text;
  const Out out = std::back_inserter(text);
  scene_lines(out, scene, o);
  verdict_lines(out, o);
  reservations(out, scene, o);
  text += parts_text(o.latency);
  bus_lines(out, o);
  attribution_lines(out, o);
  text += stiffness_text(o.stiffness);
  if (const auto& limits =
          scene.scenario().device_of(o.stiffness ? o.stiffness->probe.value_or(0) : 0).limits;
      o.stiffness && limits && limits->stiffness_N_m > 0) {
    fmt::format_to(out, "  the device's maker    states up to {:g} N/m\n", limits->stiffness_N_m);
  }
  engine_lines(out, scene, o);
  compared_line(out, o);
  if (scene.has_body()) text += accuracy_text(scene, o);
  text += force_text(o);
  text += loop_text(o);
  stability_lines(out, scene, o);
  text += fault_text(o);
  spectrum_lines(out, scene);
  return text;
}

}  // namespace hvp::results
