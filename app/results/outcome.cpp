#include "app/results/outcome.h"

#include <algorithm>

#include "app/results/faults.h"
#include "app/results/figures.h"
#include "app/results/flags.h"

namespace hvp::results {

namespace {

void report_shares(config::Figures& f, const BusLoad& load) {
  f.ratio("share", load.share, "the share of the time in which it was taken");
  f.ratio("worst_frame_share", load.worst_share,
          "from one frame's solution to the next one's, where that was most");
}

void report_initiators(config::Figures& f, const BusLoad& load, std::string_view help) {
  vp::BusUses had;
  for (const vp::BusUse& use : load.uses) {
    if (use.transactions > 0 || use.busy > 0) had.push_back(use);
  }
  f.list("by_initiator", help, had, [&](const vp::BusUse& use) {
    f.text("initiator", use.name, "`processor`, `board`, `traffic` or `graphics`");
    f.ratio("share", load.share_of(use), "of the time");
    f.time("busy_us", use.busy, "how long");
    f.count("bytes", use.bytes, "that it moved");
    f.count("transactions", use.transactions, "in how many");
  });
}

}  // namespace

void BusFigures::report(config::Figures& f) const {
  f.count("transactions", transactions, "the processor's");
  f.count("bytes", bytes, "that those moved");
  f.time("busy_us", busy, "the time that anybody's took");
  f.table("utilisation",
          "of the servo loop's time, set-up not included. Loosely timed, a transaction takes the "
          "bus for all its time; approximately timed, for as long as it owns it",
          [&] {
            report_shares(f, load);
            report_initiators(f, load, "who had it; who never had is left out");
          });
  f.if_present(link, [&](const Link& l) {
    f.table("pcie",
            "with `[bus.pcie]` only, of the solver board's link: the rest of `bus` is then the PCI "
            "bus, where the DAQ stays. All times are of the packets on the wire",
            [&] {
              f.table("utilisation",
                      "of the link's two directions: a read has its requests in one and its "
                      "completions in the other. Loosely timed, a packet carries its share of the "
                      "link layer's; approximately timed those count as they are sent",
                      [&] {
                        f.table("to_board", {}, [&] { report_shares(f, l.to_board); });
                        f.table("to_host", {}, [&] { report_shares(f, l.to_host); });
                        report_initiators(f, l.to_board,
                                          "the time of the direction in which the data go");
                      });
            });
  });
}

bool Outcome::held() const {
  return force_in_time() && verdict.load_held() &&
         std::ranges::all_of(error_budgets, &ErrorBudget::held);
}

bool Outcome::accuracy_measured() const {
  return accuracy && accuracy->speaks_for_all(accuracy->displacement) &&
         !(accuracy->of_another_model && error_budgets.empty());
}

bool Outcome::faults_happened() const {
  return std::ranges::any_of(faults, [](const auto& r) { return r.injected > 0; }) ||
         std::ranges::any_of(servo.errors, [](const auto& e) { return e.count > 0; }) ||
         servo.mended.lost_interrupts + servo.mended.lost_acknowledgements > 0;
}

bool Outcome::solutions_were_wrong() const {
  return std::ranges::any_of(faults, [](const auto& r) { return r.effect.wrong > 0; });
}

std::string_view Outcome::verdict_word() const {
  if (partial()) return "held so far";
  if (solutions_were_wrong()) return "held, with wrong solutions";
  if (!flags.empty()) return "held, with flags";
  if (faults_happened()) return "held, with faults";
  if (scene.timing_only) return "PASS, timing only";
  if (contact.changes == 0) return "held; no contact";
  if (!scene.body && loop.empty()) return "held; loop not closed";
  using Rest = plant::RestWatch::Verdict;
  const auto any_device = [this](Rest what) {
    return std::ranges::any_of(loop, [&](const auto& l) { return l.rest().verdict() == what; });
  };
  if (any_device(Rest::moves_on)) return "held; a device moves on";
  if (any_device(Rest::not_measured)) return "held; coming to rest not measured";
  if (!loop.empty() && !(stiffness && stiffness->margin())) return "held; gain margin not measured";
  if (scene.body && !accuracy_measured()) return "held; accuracy not measured";
  return "PASS";
}

void Outcome::report(config::Figures& f) const {
  f.text("title", scene.title, "the scenario's own line, with what `--set` changes in brackets");
  f.truth(
      "partial", partial(),
      "the run was interrupted: `deadline.frames` and `.skipped_ticks` are those that were done");
  f.count("frames_asked", scene.frames, "how many ticks the scenario asks for");
  f.truth("held", held(), "every budget of the scenario held, which is the exit status");
  f.text("verdict", held() ? verdict_word() : "not held",
         "what the terminal calls that ([virtual-platform.md](virtual-platform.md))");
  report_times(f);
  report_numbers(f);
  report_stability(f);
  report_parts(f);
}

void Outcome::report_times(config::Figures& f) const {
  f.table("deadline", "The latency of a frame: from its tick until its force is at the motor.",
          [&] {
            verdict.report_deadline(f);
            f.truth("held", force_in_time(), "there are no misses");
            verdict.report_lateness(f);
            f.table_or_null("late_probability",
                            "that a frame's force is late, beyond what these frames could show "
                            "([host.md](host.md#rare-misses)); null where the operating system's "
                            "times are not drawn",
                            late_probability);
          });
  f.table("latency", "Of all frames.", latency);
  f.table("jitter", "What moves the latency from frame to frame.",
          [&] { latency.report_jitter(f); });
  f.when(!error_budgets.empty(), [&] {
    f.tables("error_budget",
             "With `[budget] displacement_error`, `force_error`, by that name: `displacement`, "
             "`force`.",
             error_budgets, [](const ErrorBudget& b) { return b.of; });
  });
  f.table("load", "From the tick until the host has done all work of the period.",
          [&] { verdict.report_load(f); });
  verdict.report_attribution(f);
}

void Outcome::report_numbers(config::Figures& f) const {
  f.table("accuracy",
          "Against double precision, with `[reference]`. `every_frames` compares every so many "
          "frames; a static reference is then solved in those alone, a dynamic one has a state and "
          "is stepped in each. It takes no simulated time.",
          [&] {
            f.truth("measured", accuracy && accuracy->displacement.mean,
                    "there was a reference, and a frame in which the body is displaced was "
                    "compared with it. Else all figures but `rounding` are null");
            f.report(accuracy.value_or(Accuracy{}));
            f.table_or_null("rounding",
                            "what the words alone do to a few contacts along the probe's way, at "
                            "rest, found at set-up ([host.md](host.md)); null where the host "
                            "solves, where no numbers are computed, and beyond 4000 nodes",
                            rounding);
          });
  f.table_or_null("force",
                  "What the force is like, of the first probe; null where nobody computed one.",
                  force);
  f.when(!forces.empty(),
         [&] { f.list("forces", "With several `[[probe]]` only: the same of each.", forces); });
  f.table_or_null("strain",
                  "How far the body was strained, over all frames "
                  "([finite-elements.md](finite-elements.md)); null where nobody computed it.",
                  strain);
  f.when(!loop.empty() || stiffness, [&] {
    f.list("loop",
           "With `[device.dynamics]` only: what the closed loop is like, of each device "
           "([plant.md](plant.md)).",
           loop);
    f.table_or_null("stiffness",
                    "What a wall this loop could hold, and what latency costs of it "
                    "([stability.md](stability.md)); null for a delay of more than 16 periods.",
                    stiffness);
  });
  f.when(!stiffnesses.empty(), [&] {
    f.list(
        "stiffnesses",
        "With `[probe.device]` only: the same of each device with mass; `stiffness` is the least "
        "of them.",
        stiffnesses);
  });
  f.when(!tools.empty(), [&] {
    f.list("virtual_coupling",
           "With `[host.virtual_coupling]` only: of each probe's tool ([host.md](host.md)).",
           tools);
  });
  f.when(!passivity.empty(), [&] {
    f.list("passivity",
           "With `[host.passivity]` only: observer and controller of each probe "
           "([host.md](host.md)).",
           passivity);
  });
  f.table_or_null("missed_contact",
                  "How deep the tip was in the body while nothing was held, where that is flagged "
                  "`contact-missed`; else null.",
                  contact.missed);
}

void Outcome::take_stiffnesses(std::vector<StiffnessBudget> budgets) {
  const auto least = std::ranges::min_element(budgets, {}, &StiffnessBudget::edge_N_m);
  if (least == budgets.end()) return;
  stiffness = *least;
  if (least->probe) stiffnesses = std::move(budgets);
}

void Outcome::report_stability(config::Figures& f) const {
  f.table(
      "stability", "What went numerically wrong. Timing only, the counts of words are null.", [&] {
        const auto words = [&](std::string_view key, std::int64_t number, std::string_view help) {
          f.count(key, scene.timing_only ? std::nullopt : std::optional(number), help);
        };
        words("saturations", saturations, "words that reached their limit");
        words("wraps", wraps, "words that lost their high bits");
        words("breakdowns", breakdowns, "solves that a direction without curvature ended");
        words("clamped_words", servo.clamped_words, "of right-hand sides that did not fit");
        words("clamped_forces", servo.clamped_forces,
              "frames whose force did not fit the device's register");
        f.count("driver_errors", servo.driver_errors,
                "frames in which a driver's call failed, not those held while there was no "
                "board");
        f.value("flags", flag_names(flags), {},
                "names of what went wrong, see [fixed-point.md](fixed-point.md)");
      });
  f.table_or_null("remedy",
                  "What would take the flags away ([fixed-point.md](fixed-point.md), section "
                  "Remedies), where that was looked for; else null.",
                  remedy);
  f.table_if_present("refinement", "With `[refinement]` only.", refinement);
  f.table_if_present("matrix", "With `object.model.matrix.renew_every` above 0 only.", matrix);
  f.table_if_present("host_solve", "Where the host solves, see [host-solvers.md](host-solvers.md).",
                     host_solve);
  f.table_if_present("explicit_steps", "With `host.solver = \"explicit\"` only.", explicit_steps);
  f.table("driver", "What the driver returned, and what the servo loop did then.",
          [&] { report_driver(f, servo); });
  report_faults(f, faults, verdict.frames());
  f.table_if_present("flips",
                     "With faults of kind flip only ([faults.md](faults.md#bits-that-flip)).",
                     flips_of(faults));
}

void Outcome::report_parts(config::Figures& f) const {
  f.table_or_null("condition",
                  "Bounds of the extreme eigenvalues and of κ of the system without contact, where "
                  "the scenario has `[spectrum]` ([solve.md](solve.md)); else null.",
                  scene.condition);
  scene.report_resources(f);
  f.table_or_null("accelerator", "Null where the host solves.", accelerator);
  f.text("solver", scene.solver,
         "who solves: `board`, or the host itself, by `host.solver`; `wall`: there is nothing to "
         "solve");
  f.table("bus", "Of the PCI bus, set-up, which loads K, included.", bus);
  f.table_or_null("mesh",
                  "The body, and how well its tetrahedra are shaped ([mesh.md](mesh.md)); null for "
                  "a wall.",
                  scene.body);
  f.table("contact", "How the probe met the body.", contact);
  f.time("set_up_us", set_up, "from power-up until the servo loop began: K has been loaded");
  f.value("effects", scene.effects, {}, "what was simulated");
  f.table("fidelity", "How finely.", [&] { scene.report_fidelity(f); });
}

void Performance::report(config::Figures& f) const {
  f.quantity("build_scene_s", build_scene_s, "s",
             "wall-clock time to read the scenario, to mesh and to assemble");
  f.quantity("simulate_s", simulate_s, "s", "to simulate and to write the result files");
  f.quantity("remedy_s", remedy_s, "s", "to try the remedies of flags");
  f.quantity("frames_per_s", frames_per_s, "1/s", "frames over `simulate_s`");
  f.quantity("draw_s", draw_s, "s", "to draw the pictures");
  f.quantity("simulated_s", simulated_s, "s",
             "of the model, from the first tick to the end of the last frame");
  f.quantity("peak_memory_mb", peak_memory_mb, "MiB", "the most that was resident");
}

std::string summary_json(const Outcome& outcome) { return figures_json(outcome).dump(2) + "\n"; }

}  // namespace hvp::results
