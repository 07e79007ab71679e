#include "app/explain/platform_parts.h"

#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <systemc>
#include <typeinfo>

#include <cxxabi.h>

#include "app/process/child_process.h"
#include "vp/platform.h"

namespace hvp::app {

namespace {

using nlohmann::json;

// The last part of a class' name: "hvp::vp::PciBus" -> "PciBus".
std::string class_of(const sc_core::sc_object& object) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(typeid(object).name(), nullptr, nullptr, &status), &std::free);
  if (status != 0 || text == nullptr) return object.kind();
  const std::string whole = text.get();
  const std::size_t end = whole.find('<');
  const std::size_t colon = whole.rfind(':', end);
  return whole.substr(colon == std::string::npos ? 0 : colon + 1,
                      end == std::string::npos ? end : end - colon - 1);
}

// Returns nothing for an object that is not a process.
std::string process_kind(const sc_core::sc_object& object) {
  const std::string kind = object.kind();
  if (kind == "sc_thread_process" || kind == "sc_cthread_process") return "thread";
  if (kind == "sc_method_process") return "method";
  return {};
}

void add_modules(const std::vector<sc_core::sc_object*>& objects, json& modules) {
  for (const sc_core::sc_object* object : objects) {
    const std::vector<sc_core::sc_object*>& within = object->get_child_objects();
    if (dynamic_cast<const sc_core::sc_module*>(object) != nullptr) {
      json processes = json::array();
      for (const sc_core::sc_object* child : within) {
        const std::string kind = process_kind(*child);
        if (!kind.empty()) processes.push_back({{"name", child->name()}, {"kind", kind}});
      }
      modules.push_back(
          {{"name", object->name()}, {"kind", class_of(*object)}, {"processes", processes}});
    }
    add_modules(within, modules);
  }
}

std::string look_at_platform(Scene& scene) {
  std::optional<vp::SoftBody> soft;
  if (scene.has_body()) {
    soft.emplace(soft_body(scene));
  }
  // SystemC's warning that a waveform's file is not written is suppressed, as nothing is simulated
  // here.
  sc_core::sc_report_handler::set_actions(
      "trace file closed before any cycles were traced, file not written", sc_core::SC_DO_NOTHING);
  const vp::Platform platform(platform_settings(scene, "engine"), soft, nullptr);
  json modules = json::array();
  add_modules(sc_core::sc_get_top_level_objects(), modules);
  return modules.dump();
}

}  // namespace

std::size_t PlatformParts::processes() const {
  std::size_t count = 0;
  for (const PlatformModule& module : modules) count += module.processes.size();
  return count;
}

PlatformParts platform_parts(Scene& scene) {
  PlatformParts parts;
  for (const json& module : json::parse(in_child([&scene] { return look_at_platform(scene); }))) {
    PlatformModule read{
        module.at("name").get<std::string>(), module.at("kind").get<std::string>(), {}};
    for (const json& process : module.at("processes")) {
      read.processes.push_back(
          {process.at("name").get<std::string>(), process.at("kind").get<std::string>()});
    }
    parts.modules.push_back(std::move(read));
  }
  return parts;
}

}  // namespace hvp::app
