#include "app/results/frames_csv.h"

#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "driver/hvp_driver.h"
#include "models/plant/loop_quality.h"

namespace hvp::results {

namespace {

// Appends the components, with zero for negative zero.
void append(std::string& fields, const Eigen::Vector3d& vector) {
  for (const double component : vector) fields += "," + shortest(component + 0.0);
}

// The fields of a probe that is not the first one.
std::string further_fields(const vp::Frame& f, std::size_t probe, Columns columns) {
  std::string fields = fmt::format(",{}", f.touches[probe].contact.node);
  append(fields, f.read(probe));
  if (columns == Columns::all) {
    append(fields, -f.sent(probe));
  } else {
    fields += ",,,";
  }
  return fields;
}

}  // namespace

std::vector<FrameColumn> frame_columns() {
  std::vector<FrameColumn> columns = {
      {"frame", "number"},
      {"born_us", "its tick, since the servo loop began"},
      {"latency_us", "from its tick until its force is at the motor"},
      {"load_us", "from its tick until the host has done all its work"},
      {"deadline_us", "the latency that is allowed"},
      {"in_time", "1 where the force was in time and the frame's own"},
      {"contact_node", "mesh node, -1 without contact"},
      {"contact_age_us", "how old the collision pass was that found it"},
      {"x_m", "the tip as the host read it"},
      {"y_m", "likewise"},
      {"z_m", "likewise"},
      {"force_N",
       "the force on the probe that the host asks for; converter and limits of a device come after "
       "it: `motor_x_N` and so on are what acts"},
      {"fx_N", "its component"},
      {"fy_N", "likewise"},
      {"fz_N", "likewise"},
      {"saturations", "of the frame's solve"},
      {"flags", "likewise; bit n is entry n of `stability::Flag`"}};
  for (const std::string_view part : vp::kPartNames) {
    columns.push_back({fmt::format("{}_us", part),
                       "what the part added to the latency, on the critical path; all parts sum to "
                       "`latency_us` exactly"});
  }
  columns.push_back({"status",
                     "`HVP_OK`, or why the force of an earlier frame was held: what the driver "
                     "returned last ([driver.md](driver.md))"});
  return columns;
}

std::vector<FrameColumn> probe_columns(const ProbeColumns& of, std::size_t index) {
  std::vector<FrameColumn> columns;
  const std::string prefix = index == 0 ? "" : fmt::format("probe{}_", index);
  const auto add = [&](std::string_view name, std::string help) {
    columns.push_back({prefix + std::string(name), std::move(help)});
  };
  if (of.flips && index == 0) {
    add("flips", "with faults of kind flip: bits that flip behind the start of the frame's job");
  }
  const auto vector = [&](std::string_view name, std::string_view unit, std::string_view help) {
    for (const char* axis : {"x", "y", "z"}) {
      add(fmt::format("{}_{}_{}", name, axis, unit),
          axis[0] == 'x' ? std::string(help) : std::string("likewise"));
    }
  };
  if (index > 0) {
    add("contact_node", "as the first probe's columns of these names");
    for (const char* name : {"x_m", "y_m", "z_m", "fx_N", "fy_N", "fz_N"}) add(name, "likewise");
  }
  if (of.proxies) {
    vector(
        "foot", "m",
        "with `contact.kind = \"proxy\"`: the point of the surface at rest; zero without contact");
    add("gap_m", "from the tip to the body's surface there; zero without contact");
    add("slides", "1 where it moved over the surface, or the force came onto Coulomb's cone");
  }
  if (of.tools) {
    vector("tool", "m", "with `[host.virtual_coupling]`: where the tool was that body or wall saw");
  }
  if (of.passivity) {
    vector("damping", "N",
           "with `[host.passivity]`: what the controller added to the force on the probe; it is in "
           "`force_N`");
    add("observed_J", "what its observer had counted by then");
  }
  if (!of.probes[index].device) return columns;
  vector("tip", "m", "with `[device.dynamics]`: where the tip was when it was latched");
  vector("intended", "m", "where the hand wanted it; empty where nobody holds the device");
  vector("motor", "N", "the motors' real force on the tip then");
  vector("hand", "N", "the hand's");
  add("stored_J", "kinetic energy and the springs of structure and hand then");
  add("port_J",
      "what all but masses and hand have absorbed until then, with what the wall's spring had at "
      "the start");
  add("fed_in",
      "1 where that is below zero by more than rounding explains: the loop fed energy in");
  if (of.probes[index].structure) {
    vector("handle", "m", "with `[device.structure]`: where the handle was then");
  }
  if (!of.probes[index].currents) return columns;
  vector("commanded", "A", "with `[device.motor]`: the current that the frame's force asks for");
  vector("current", "A", "what converter and amplifier make of it, before the amplifier's lag");
  vector("read", "A", "with `[device.adc]`: the current as the host read it; else 0");
  return columns;
}

FramesCsv::FramesCsv(const std::filesystem::path& path, vp::Picoseconds budget, Columns columns,
                     ProbeColumns probes)
    : stream_(path),
      budget_(budget),
      columns_(columns),
      probes_(std::move(probes)),
      at_start_J_(probes_.probes.size()) {
  std::string header;
  for (const FrameColumn& column : frame_columns()) {
    header += (header.empty() ? "" : ",") + column.name;
  }
  for (std::size_t i = 0; i < probes_.probes.size(); ++i) {
    for (const FrameColumn& column : probe_columns(probes_, i)) header += "," + column.name;
  }
  stream_.write(header + "\n");
}

void FramesCsv::closed(const vp::Frame& f, const vp::CriticalPath& path) {
  // A host that is another program has probes of its own.
  collision::Touch touch;
  if (!f.touches.empty()) touch = {f.read(0), f.touch().contact, f.sent(0)};
  fmt::memory_buffer line;
  const auto out = std::back_inserter(line);
  fmt::format_to(out, "{},{},{},{},{},{},{},{},{},{},{},", f.number, microseconds(f.time),
                 microseconds(f.latency()), microseconds(f.work_done - f.born),
                 microseconds(budget_), f.solved() && f.latency() <= budget_ ? 1 : 0,
                 touch.contact.node, microseconds(f.contact_age), shortest(touch.tip.x()),
                 shortest(touch.tip.y()), shortest(touch.tip.z()));
  if (columns_ == Columns::all) {
    const Eigen::Vector3d on_probe = Eigen::Vector3d::Zero() - touch.force;  // no negative zeros
    fmt::format_to(out, "{},{},{},{},{},", shortest(on_probe.norm()), shortest(on_probe.x()),
                   shortest(on_probe.y()), shortest(on_probe.z()), f.saturations);
  } else {
    fmt::format_to(out, ",,,,,");
  }
  fmt::format_to(out, "{}", f.flags);
  for (std::size_t part = 0; part < vp::kParts; ++part) {
    fmt::format_to(out, ",{}", microseconds(path.time(static_cast<vp::Part>(part))));
  }
  fmt::format_to(out, ",{}", hvp_status_name(f.status));
  stream_.write({line.data(), line.size()});
  for (std::size_t i = 0; i < probes_.probes.size(); ++i) {
    if (i == 0 && probes_.flips) stream_.write(fmt::format(",{}", f.flips));
    if (i > 0) stream_.write(further_fields(f, i, columns_));
    if (probes_.proxies) stream_.write(proxy_fields(f, i));
    if (!f.ports.empty()) stream_.write(port_fields(f, i));
    if (probes_.probes[i].device) stream_.write(device_fields(f, i));
  }
  stream_.write("\n");
}

std::string FramesCsv::proxy_fields(const vp::Frame& f, std::size_t i) const {
  // A host that is another program has contacts of its own.
  collision::Touch touch;
  if (i < f.touches.size() && f.touches[i].contact.present()) touch = f.touches[i];
  std::string fields;
  append(fields, touch.foot);
  if (columns_ == Columns::times) return fields + ",,";
  return fields + fmt::format(",{},{}", shortest(touch.gap), touch.slides ? 1 : 0);
}

std::string FramesCsv::port_fields(const vp::Frame& f, std::size_t i) const {
  std::string fields;
  if (probes_.tools) append(fields, f.touches[i].tip);
  if (probes_.passivity) {
    append(fields, -f.ports[i].damping);
    fields += "," + shortest(f.ports[i].observed_J + 0.0);
  }
  return fields;
}

std::string FramesCsv::device_fields(const vp::Frame& f, std::size_t i) {
  std::string fields;
  const vp::DeviceRecord& d = f.devices[i];
  append(fields, d.plant.tip.position);
  const vp::Picoseconds latched = f.time + f.latched - f.born;
  const ProbeColumnsOf& of = probes_.probes[i];
  const std::optional<plant::Hand>& hand = of.hand;
  if (hand && !(hand->lets_go_s > 0 && to_seconds(latched) >= hand->lets_go_s)) {
    append(fields, of.probe.state_ps(latched).position);
  } else {
    fields += ",,,";
  }
  append(fields, d.plant.motor_force);
  append(fields, d.plant.hand_force);
  const plant::Energy& e = d.plant.energy;
  std::optional<double>& at_start = at_start_J_[i];
  if (!at_start) at_start = probes_.wall ? probes_.wall->energy(d.plant.tip.position) : 0;
  const double at_port = *at_start + e.at_port();
  fields += fmt::format(",{},{},{}", shortest(e.kinetic + e.springs), shortest(at_port),
                        plant::LoopEnergy::fed_in(at_port, e) ? 1 : 0);
  if (of.structure) append(fields, d.plant.handle.position);
  if (of.currents) {
    append(fields, d.drive.commanded_current);
    append(fields, d.drive.current);
    append(fields, d.read_current);
  }
  return fields;
}

}  // namespace hvp::results
