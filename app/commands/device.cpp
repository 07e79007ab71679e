#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/commands/terminal.h"
#include "app/design/design_figures.h"
#include "app/results/design_report.h"
#include "app/results/figures_json.h"

namespace hvp::app {

int device_command(const DeviceArguments& arguments) {
  const LoadedScenario loaded = load(arguments);
  const Scene scene = build_scene(loaded, make_progress(arguments.quiet), Scene::Limits::reported);
  end_progress(arguments.quiet);
  const DesignFigures figures = design_figures(scene);
  if (arguments.json) {
    print("{}\n", results::figures_json(results::design_report(scene, figures)).dump(2));
  } else {
    print("{}", results::design_text(scene, figures));
  }
  const bool held = figures.usage.fits() && figures.clock_is_reached(scene.scenario().accelerator);
  return held ? kHeld : kNotHeld;
}

}  // namespace hvp::app
