#include "app/results/host_solve.h"

#include "app/scene/scene.h"
#include "models/time/picoseconds.h"

namespace hvp::results {

void HostSolveFigures::report(config::Figures& f) const {
  f.text("precision", precision, "of its numbers");
  f.text("model", model, "whose figures price it, by `host.model`");
  f.quantity("memory_bytes", memory_bytes, "B", "that it keeps between frames");
  f.quantity("working_set_bytes", working_set_bytes, "B",
             "that every frame touches, which decides the tier of memory");
  f.value("operations", operations, {}, "of a solve without contact, with all its iterations");
  f.quantity("bytes", bytes, "B", "that such a solve reads and writes");
  f.time("solve_us", solve_ps, "what it takes");
  f.time("rest_us", rest_ps, "what is solved for after the force, beside it");
  f.time("set_up_us", set_up_ps, "what is made before the first frame: factors, inverses");
}

std::optional<HostSolveFigures> host_solve_figures(const app::Scene& scene) {
  const host::Host& host = scene.scenario().host;
  if (host.solver == host::SolvedBy::board) return std::nullopt;
  const host::FrameMethod& method = scene.computation().method();
  const host::SolveMemory memory = method.memory();
  HostSolveFigures figures;
  figures.precision = host::name(host.precision);
  figures.model = host::name(host.model);
  figures.memory_bytes = memory.kept;
  figures.working_set_bytes = memory.working_set;
  for (const host::Step& step : method.steps()) {
    if (step.where == host::Step::Where::core) {
      figures.rest_ps +=
          step.times * to_picoseconds(host.core_solve_s(step.work, step.memory.working_set));
    }
    if (step.where != host::Step::Where::solver) continue;
    figures.solve_ps += step.times * to_picoseconds(host.solve_s(step.work, step.memory));
    figures.operations += step.times * step.work.operations();
    figures.bytes += step.times * step.work.bytes;
  }
  figures.set_up_ps = to_picoseconds(host.core_solve_s(method.set_up_work(), memory.set_up));
  return figures;
}

}  // namespace hvp::results
