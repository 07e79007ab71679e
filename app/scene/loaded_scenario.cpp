#include "app/scene/loaded_scenario.h"

#include <optional>
#include <utility>

#include "app/devices/devices.h"
#include "app/scenario/files.h"
#include "app/scenario/reader.h"
#include "app/scene/samples.h"
#include "app/scene/scenario.h"
#include "models/config/input_error.h"

namespace hvp::app {

namespace {

template <class Distribution>
void take(std::optional<Distribution>& effect, const char* table) {
  if (!effect || effect->kind != random::TimeDistribution::Kind::measured) return;
  within(table, [&] {
    Samples samples = read_samples(effect->samples_file.path);
    effect->take(std::move(samples.times_s), std::move(samples.counts));
  });
}

}  // namespace

LoadedScenario load_untitled(const ScenarioSource& source) {
  return read_document(
      scenario::Document::load(source.scenario, source.overrides, source.includes));
}

LoadedScenario read_document(scenario::Document document) {
  LoadedScenario loaded{std::move(document), {}, {}, {}, {}};
  devices::put_devices_under(loaded.document);
  scenario::read(loaded.document, loaded.scenario);
  scenario::resolve_files(loaded.document, loaded.scenario);
  const accel::Architecture& accelerator = loaded.scenario.accelerator;
  loaded.device = devices::find(loaded.document, accelerator);
  loaded.device_file = devices::openable(loaded.document, accelerator.device);
  return loaded;
}

void require_board_with_words(const Scenario& s) {
  if (s.wall) {
    throw InputError("wall", "the scenario has a wall and no board: expected one with [object]");
  }
  if (s.host.solver != host::SolvedBy::board) {
    throw InputError("host.solver", "the host solves and there is no board: expected \"board\"");
  }
  if (s.timing_only()) {
    throw InputError("fidelity.numbers",
                     "a board without numbers has nothing to tell another program: expected "
                     "\"fixed\"");
  }
}

void require_board_with_words(const LoadedScenario& loaded) try {
  require_board_with_words(loaded.scenario);
} catch (const InputError& e) {
  throw loaded.document.complete(e);
}

void take_samples(Scenario& scenario) {
  take(scenario.host.jitter, "host.jitter");
  take(scenario.host.wake_up, "host.wake_up");
  take(scenario.host.interrupt_latencies, "host.interrupt_latencies");
  if (scenario.host.gpu) take(scenario.host.gpu->latencies, "host.gpu.latencies");
  take(scenario.bus.read_latencies, "bus.read_latencies");
  if (scenario.bus.pcie) {
    take(scenario.bus.pcie->root_complex_latencies, "bus.pcie.root_complex_latencies");
  }
}

}  // namespace hvp::app
