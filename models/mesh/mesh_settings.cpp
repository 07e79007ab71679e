#include "models/mesh/mesh_settings.h"

#include "models/config/input_error.h"

namespace hvp::mesh {

using config::Dimension;

void MeshSettings::declare(config::Visitor& v) {
  const auto of_shape = v.variant(
      "shape", shape, {{"sphere", Shape::sphere}, {"box", Shape::box}, {"surface", Shape::surface}},
      {.help = "the body: a sphere or a box centred on the origin, or a surface file",
       .source = "thesis §6.2.4: a sphere"});
  of_shape.only({Shape::sphere}, [&] {
    v.quantity("radius", radius, Dimension::length, kBodyLength,
               {.help = "radius of the sphere",
                .source = "the thesis names none; 5 cm is the scene its figures are checked with"});
  });
  of_shape.only({Shape::box}, [&] {
    v.vector("size", size, Dimension::length, kBodyLength,
             {.help = "edges of the box along x, y, z",
              .source = "a cube as wide as the default sphere"});
  });
  of_shape.only({Shape::surface}, [&] {
    v.file("surface", surface,
           {.help = "closed surface of the body: STL, PLY, OBJ, VTP or VTU", .required = true});
    v.quantity("surface_unit", surface_unit, Dimension::length, kUnitLength,
               {.help = "length of one unit of the surface file",
                .source = "surface files carry no unit; millimetres are customary in STL"});
  });
  v.integer("nodes", nodes, {.min = 4, .max = 1'000'000},
            {.help = "wanted number of nodes, mid-edge nodes included, met within 10 %",
             .source = "thesis §6.2.4: 500"});
}

void MeshSettings::check() const {
  if (shape == Shape::surface && surface.empty()) {
    throw InputError("surface", "shape = \"surface\" needs a file (STL, PLY, OBJ, VTP or VTU)");
  }
}

}  // namespace hvp::mesh
