#include "models/accel/fit.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "models/accel/critical_path.h"
#include "models/accel/memory.h"
#include "models/accel/multipliers.h"
#include "models/config/input_error.h"

namespace hvp::accel {

namespace {

// An architecture that differs in one key.
struct Change {
  Proposal proposal;
  Architecture architecture;
};

std::string setting(const std::string& key, const std::string& value) {
  return "accelerator." + key + " = " + value;
}

// True if the system fits and the clock is reached: nothing else is worth a proposal.
bool works(const Device& device, const Architecture& a, const WordLengths& words,
           const Pattern& p) {
  if (!usage(device, a, words, p).fits()) return false;
  return !device.timing || highest_clock({device, a, words, p.nodes()}) >= a.clock_hz;
}

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

// The architecture of a change that is added; the key is still to be changed in it.
Architecture& add(std::vector<Change>& changes, std::string setting, const Architecture& a) {
  changes.push_back({{{std::move(setting)}, {}}, a});
  return changes.back().architecture;
}

std::string_view key_of_setting(std::string_view text) { return text.substr(0, text.find(' ')); }

// The other memory types for a structure.
void retype(const Device& device, const Architecture& a, Role role,
            std::string Architecture::*choice, std::vector<Change>& changes) {
  const MemoryType& now = memory_for(device, a, role);
  for (const MemoryType& type : device.memories) {
    if (&type == &now) continue;
    add(changes, setting(key_of(role), quoted(type.name)), a).*choice = type.name;
  }
}

std::vector<Change> changes_of(const Device& device, const Architecture& a,
                               const WordLengths& words) {
  std::vector<Change> changes;
  retype(device, a, Role::matrix, &Architecture::matrix_memory, changes);
  if (words.preconditioned()) {
    retype(device, a, Role::preconditioner, &Architecture::preconditioner_memory, changes);
  }
  retype(device, a, Role::vectors, &Architecture::vector_memory, changes);
  retype(device, a, Role::copies, &Architecture::copies_memory, changes);
  retype(device, a, Role::index, &Architecture::index_memory, changes);
  if (!a.parity_bits) add(changes, setting("parity_bits", "true"), a).parity_bits = true;
  for (const MultiplierMode& mode : device.multipliers) {
    if (&mode == &multiplier_mode(device, a)) continue;
    add(changes, setting("multiplier_mode", quoted(mode.name)), a).multiplier_mode = mode.name;
  }
  if (!a.several && a.matrix_storage == MatrixStorage::full) {
    add(changes, setting("matrix_storage", quoted("symmetric")), a).matrix_storage =
        MatrixStorage::symmetric;
    changes.back().proposal.remark = "(loosely-timed)";
  }
  return changes;
}

// The most partitions, fewer than now, with which it fits.
std::optional<int> fewer_partitions(const Device& device, Architecture a, const WordLengths& words,
                                    const Pattern& p) {
  while (a.partitions > 1) {
    --a.partitions;
    if (works(device, a, words, p)) return a.partitions;
  }
  return std::nullopt;
}

std::string partitions(int count) { return setting("partitions", std::to_string(count)); }

// Two changes at once, with as few fewer partitions as it takes.
std::vector<Proposal> pairs_that_fit(const Device& device, const WordLengths& words,
                                     const Pattern& p, const std::vector<Change>& changes) {
  std::vector<Proposal> fitting;
  for (const Change& first : changes) {
    for (const Change& second : changes_of(device, first.architecture, words)) {
      const std::string& added = second.proposal.settings.front();
      // Each pair once, and a key once.
      if (!(first.proposal.settings.front() < added)) continue;
      if (key_of_setting(added) == key_of_setting(first.proposal.settings.front())) continue;
      std::optional<int> fewer = second.architecture.partitions;
      if (!works(device, second.architecture, words, p)) {
        fewer = fewer_partitions(device, second.architecture, words, p);
      }
      if (!fewer) continue;
      fitting.push_back(first.proposal);
      fitting.back().settings.push_back(added);
      if (*fewer != second.architecture.partitions) {
        fitting.back().settings.push_back(partitions(*fewer));
      }
      if (fitting.back().remark.empty()) fitting.back().remark = second.proposal.remark;
    }
  }
  return fitting;
}

// On this device.
std::vector<Proposal> changes_that_fit(const Device& device, const Architecture& a,
                                       const WordLengths& words, const Pattern& p) {
  std::vector<Proposal> fitting;
  if (const auto fewer = fewer_partitions(device, a, words, p)) {
    fitting.push_back({{partitions(*fewer)}, {}});
  }
  const std::vector<Change> changes = changes_of(device, a, words);
  for (const Change& change : changes) {
    if (works(device, change.architecture, words, p)) fitting.push_back(change.proposal);
  }
  if (!fitting.empty()) return fitting;
  for (const Change& change : changes) {
    const auto fewer = fewer_partitions(device, change.architecture, words, p);
    if (!fewer) continue;
    fitting.push_back(change.proposal);
    fitting.back().settings.push_back(partitions(*fewer));
  }
  if (fitting.empty()) fitting = pairs_that_fit(device, words, p, changes);
  return fitting;
}

// Another device has other memory types and modes.
Architecture without_choices(Architecture a) {
  const Architecture defaults;
  a.matrix_memory = defaults.matrix_memory;
  a.index_memory = defaults.index_memory;
  a.copies_memory = defaults.copies_memory;
  a.vector_memory = defaults.vector_memory;
  a.preconditioner_memory = defaults.preconditioner_memory;
  a.queue_memory = defaults.queue_memory;
  a.multiplier_mode = defaults.multiplier_mode;
  return a;
}

// The settings for another device; none if the system does not fit on it either.
std::optional<Proposal> with_device(const Device& other, const Architecture& a,
                                    const WordLengths& words, const Pattern& p) {
  Proposal proposal{{setting("device", quoted(other.name))}, {}};
  try {
    if (works(other, a, words, p)) return proposal;
  } catch (const InputError&) {  // it has not the types and modes that are chosen
  }
  if (!works(other, without_choices(a), words, p)) return std::nullopt;
  proposal.remark = "with every memory key and multiplier_mode left out";
  return proposal;
}

// "480 M4K of 255, 154 multipliers of 144"
std::string shortage(const Usage& u) {
  std::string text;
  const auto add = [&text](const std::string& what) { text += (text.empty() ? "" : ", ") + what; };
  for (const Resource& r : u.resources) {
    if (r.used <= r.available) continue;
    add(std::to_string(r.used) + " " + r.type + " of " + std::to_string(r.available));
  }
  for (const Obstacle& o : u.obstacles) add(o.reason);
  return text;
}

// A body of fewer nodes is none.
constexpr int kFewestNodes = 20;
// Another mesh of the same body has not quite the same rows, and anchors hold another share of it:
// up to 3 % in the meshes tried.
constexpr double kMeshReserve = 0.97;

}  // namespace

std::string Proposal::text() const {
  std::string result;
  for (const std::string& s : settings) result += (result.empty() ? "" : " with ") + s;
  return remark.empty() ? result : result + " " + remark;
}

std::vector<Proposal> proposals_that_fit(const Device& device, const Architecture& a,
                                         const WordLengths& words, const Pattern& p,
                                         std::span<const Device* const> others) {
  std::vector<Proposal> fitting = changes_that_fit(device, a, words, p);
  for (const Device* other : others) {
    if (other->name == device.name) continue;
    std::optional<Proposal> proposal = with_device(*other, a, words, p);
    if (!proposal) continue;
    fitting.push_back(std::move(*proposal));
    break;
  }
  return fitting;
}

std::vector<std::string> what_would_fit(const Device& device, const Architecture& a,
                                        const WordLengths& words, const Pattern& p,
                                        std::span<const Device* const> others) {
  std::vector<std::string> texts;
  for (const Proposal& proposal : proposals_that_fit(device, a, words, p, others)) {
    texts.push_back(proposal.text());
  }
  return texts;
}

void require_fit(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p, std::span<const Device* const> others, int mesh_nodes) {
  const Usage u = usage(device, a, words, p);
  if (u.fits()) return;
  std::vector<std::string> fitting;
  const int nodes = largest_mesh(device, a, words, p);
  if (nodes >= kFewestNodes) {
    fitting.push_back("about " + std::to_string(nodes) + " nodes with such rows");
    if (mesh_nodes > 0) {
      const auto in_mesh = static_cast<std::int64_t>(kMeshReserve * static_cast<double>(nodes) *
                                                     mesh_nodes / p.nodes());
      fitting.back() += " (object.mesh.nodes = " + std::to_string(in_mesh) + ")";
    }
  }
  for (std::string& change : what_would_fit(device, a, words, p, others)) {
    fitting.push_back(std::move(change));
  }
  std::string message = "the " + device.name + " cannot hold this system of " +
                        std::to_string(p.nodes()) + " nodes: " + shortage(u);
  const char* separator = "; what fits: ";
  for (const std::string& change : fitting) {
    message += separator + change;
    separator = ", or ";
  }
  if (fitting.empty()) message += "; nothing that was tried fits";
  throw InputError("device", message);
}

}  // namespace hvp::accel
