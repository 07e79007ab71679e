#include "vp/frame/frame.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "vp/frame/tenure.h"

namespace hvp::vp {

bool Frame::in_contact() const {
  return std::ranges::any_of(touches,
                             [](const collision::Touch& t) { return t.contact.present(); });
}

void broken(const Frame& frame, const std::string& what) {
  throw std::logic_error("frame " + std::to_string(frame.number) + ": " + what);
}

std::string_view name(Part part) { return kPartNames.at(static_cast<std::size_t>(part)); }

std::string_view name(Resource resource) {
  switch (resource) {
    case Resource::core_0:
      return "core 0";
    case Resource::core_1:
      return "core 1";
    case Resource::bus:
      return "bus";
    case Resource::link_to_board:
      return "link to board";
    case Resource::link_to_host:
      return "link to host";
  }
  return "";
}

std::string_view name(Phase phase) { return kPhaseNames.at(static_cast<std::size_t>(phase)); }

}  // namespace hvp::vp
