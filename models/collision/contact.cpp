#include "models/collision/contact.h"

namespace hvp::collision {

void ContactSettings::declare(config::Visitor& v) {
  const auto of_kind = v.variant(
      "kind", kind,
      {{"node", ContactKind::node}, {"proxy", ContactKind::proxy}, {"patch", ContactKind::patch}},
      {.help = "what the tip touches: a node of the mesh, which follows it, or a point of the "
               "surface, which presses on the body, sticks by friction and glides beyond, or a "
               "patch as large as the probe, which does so for probes larger than an element",
       .source = "proxy: on a slide a node runs ahead of the tip, which docs/collision.md "
                 "measures; node is thesis 3.7"});
  of_kind.only({ContactKind::proxy, ContactKind::patch}, [&] {
    v.quantity("friction", friction, config::Dimension::dimensionless, config::between(0.0, 1e6),
               {.help = "Coulomb's coefficient between probe and body",
                .source = "chosen: a moist surface under a gloved finger is between 0.1 and 0.5"});
  });
  of_kind.only({ContactKind::node}, [&] { declare_node(v); });
  v.effect("fresh", fresh,
           {"contact is found anew in every frame: what if the contact node had no age?",
            "no simulated time; a search a frame"});
}

void ContactSettings::declare_node(config::Visitor& v) {
  v.choice("grip", grip, {{"offset", Grip::offset}, {"snap", Grip::snap}},
           {.help = "where the contact node is relative to the tip: at its sideways distance when "
                    "contact began, or at the tip itself",
            .source = "snap is thesis 3.7; offset touches without a sideways jump of up to half "
                      "an element, which the thesis does not treat"});
  v.quantity("hysteresis", hysteresis, config::Dimension::dimensionless, config::between(0.0, 0.9),
             {.help = "fraction by which another node must be nearer to the tip for contact to "
                      "slide there",
              .source = "chosen; keeps contact from chattering between two nodes"});
  v.quantity("release_force", release_force, config::Dimension::force, config::between(0.0, 1e9),
             {.help = "pull of the tip on the body, along the outward normal, above which contact "
                      "ends",
              .source = "zero: a tip cannot pull"});
  v.quantity("patch_radius", patch_radius, config::Dimension::length, config::between(0.0, 1e3),
             {.help = "nodes within this distance along the surface move with the contact node; "
                      "0 mm is one node, whose stiffness falls with the element size",
              .source = "zero: single-point contact, thesis 3.7"});
  v.quantity("hand_over", hand_over_s, config::Dimension::time, config::between(0.0, 1.0),
             {.help = "how long a new contact node takes from where it is to the tip; 0 s jumps, "
                      "which is a blow to a body with mass",
              .source = "one period of the collision process; thesis 3.7 jumps"});
}

}  // namespace hvp::collision
