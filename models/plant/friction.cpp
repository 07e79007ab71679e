#include "models/plant/friction.h"

#include "fmt/format.h"
#include "models/config/input_error.h"

namespace hvp::plant {

void Friction::declare(config::Visitor& v) {
  v.quantity("force", force_N, config::Dimension::force, config::between(0, 100),
             {"dry friction against a device that slips, along each axis",
              "Phantom Omni, backdrive friction 0.26 N (data sheet); Premium 1.5: 0.04 N"});
  v.quantity("static_force", static_force_N, config::Dimension::force, config::between(0, 100),
             {"what holds a device that stands; 0: as much as force", "no data sheet states it"});
}

void Friction::check() const {
  if (hold() >= force_N) return;
  throw InputError("static_force",
                   fmt::format("{:g} N; expected 0, or at least force, which is {:g} N",
                               static_force_N, force_N));
}

}  // namespace hvp::plant
