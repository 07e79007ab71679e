#include "models/mesh/mesh_settings.h"

#include "models/config/input_error.h"

namespace hvp::mesh {

using config::Dimension;

void MeshSettings::declare(config::Visitor& v) {
  v.choice("shape", shape,
           {{"sphere", Shape::sphere}, {"box", Shape::box}, {"surface", Shape::surface}},
           {.help = "the body: a sphere or a box centred on the origin, or a surface file",
            .source = "thesis §6.2.4: a sphere"});
  v.quantity("radius", radius, Dimension::length, config::above(0.0),
             {.help = "radius of the sphere",
              .source = "the thesis names none; 5 cm is the scene its figures are checked with"});
  v.vector(
      "size", size, Dimension::length, config::above(0.0),
      {.help = "edges of the box along x, y, z", .source = "a cube as wide as the default sphere"});
  v.file("surface", surface,
         {.help = "closed surface of the body: STL, PLY, OBJ, VTP or VTU",
          .source = "absent: needed by the shape \"surface\" only"});
  v.quantity("surface_unit", surface_unit, Dimension::length, config::above(0.0),
             {.help = "length of one unit of the surface file",
              .source = "surface files carry no unit; millimetres are customary in STL"});
  v.integer("nodes", nodes, {.min = 4, .max = 1'000'000},
            {.help = "wanted number of nodes, met within 10 %", .source = "thesis §6.2.4: 500"});
}

void MeshSettings::check() const {
  const MeshSettings defaults;
  if (shape == Shape::surface && surface.empty()) {
    throw InputError("surface", "shape = \"surface\" needs a file (STL, PLY, OBJ, VTP or VTU)");
  }
  if (shape != Shape::surface && !surface.empty()) {
    throw InputError("surface", "a surface file is given, but shape is not \"surface\"");
  }
  if (shape != Shape::surface && surface_unit != defaults.surface_unit) {
    throw InputError("surface_unit", "belongs to shape = \"surface\" only");
  }
  if (shape != Shape::sphere && radius != defaults.radius) {
    throw InputError("radius", "belongs to shape = \"sphere\" only");
  }
  if (shape != Shape::box && size != defaults.size) {
    throw InputError("size", "belongs to shape = \"box\" only");
  }
}

}  // namespace hvp::mesh
