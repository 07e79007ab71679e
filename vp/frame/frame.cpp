#include "vp/frame/frame.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace hvp::vp {

bool Frame::in_contact() const {
  return std::ranges::any_of(touches,
                             [](const collision::Touch& t) { return t.contact.present(); });
}

void broken(const Frame& frame, const std::string& what) {
  throw std::logic_error("frame " + std::to_string(frame.number) + ": " + what);
}

std::string_view name(Part part) { return kPartNames.at(static_cast<std::size_t>(part)); }

std::string_view name(Phase phase) { return kPhaseNames.at(static_cast<std::size_t>(phase)); }

}  // namespace hvp::vp
