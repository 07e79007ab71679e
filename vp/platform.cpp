#include "vp/platform.h"

#include <exception>

#include "vp/host/dma_memory.h"
#include "vp/host/local_time.h"
#include "vp/main_stack.h"

namespace hvp::vp {

namespace {

Workload workload_of(const PlatformSettings& settings, const std::optional<SoftBody>& soft) {
  if (!soft) return {.has_board = false};
  const host::FrameComputation& computation = soft->computation;
  return {.has_board = computation.on_host() == nullptr,
          .numbers = computation.timing_only() ? Numbers::none : Numbers::fixed,
          .memory_bytes = DmaMemory::needed(settings.transfer, settings.solver,
                                            computation.displacement().size()),
          .vertices = static_cast<std::int64_t>(soft->contacts.surface().surface_nodes().size())};
}

template <class Visit>
void visit_objects(const std::vector<sc_core::sc_object*>& objects, const Visit& visit) {
  for (sc_core::sc_object* object : objects) {
    visit(*object);
    visit_objects(object->get_child_objects(), visit);
  }
}

}  // namespace

// The order of construction is that of modules and processes, which results depend on.
Platform::Platform(const PlatformSettings& settings, const std::optional<SoftBody>& soft,
                   AccessObserver* register_trace)
    : settings_(settings),
      verdict_(settings.period, settings.budget),
      side_(settings_, workload_of(settings_, soft), session_, ledger_, register_trace),
      host_(settings_, soft, side_, ledger_, verdict_, session_) {
  ledger_.add_observer(verdict_);
  host_.connect();
}

void Platform::run() {
  LocalTime::set_quantum(to_picoseconds(settings_.host.quantum_s));
  sc_core::sc_start();
  return_to_main_stack();
  if (servo().failure()) std::rethrow_exception(servo().failure());
}

std::vector<std::string> Platform::modules() {
  std::vector<std::string> names;
  visit_objects(sc_core::sc_get_top_level_objects(), [&names](const sc_core::sc_object& object) {
    if (dynamic_cast<const sc_core::sc_module*>(&object) != nullptr) {
      names.emplace_back(object.name());
    }
  });
  return names;
}

std::size_t Platform::processes() {
  std::size_t count = 0;
  visit_objects(sc_core::sc_get_top_level_objects(), [&count](const sc_core::sc_object& object) {
    const std::string kind = object.kind();
    if (kind == "sc_thread_process" || kind == "sc_method_process") ++count;
  });
  return count;
}

}  // namespace hvp::vp
