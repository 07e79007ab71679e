#include "models/mesh/surface_reader.h"

#include "models/config/input_error.h"

namespace hvp::mesh {

Surface read_surface(const std::string& path, double /*unit_m*/) {
  throw InputError("surface", "cannot read " + path);
}

}  // namespace hvp::mesh
