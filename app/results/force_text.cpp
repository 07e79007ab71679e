#include <iterator>

#include <fmt/format.h>

#include "app/results/number_text.h"
#include "app/results/report_sections.h"

namespace hvp::results {

namespace {

using Out = std::back_insert_iterator<std::string>;

void force_lines(Out out, const stability::ForceQuality& force, const ContactFigures& contact) {
  fmt::format_to(out, "\nForce        largest {} (frame {}), contact in {} of the frames\n",
                 newtons(force.peak().value), force.peak().frame, percent(contact.share()));
  fmt::format_to(out, "  step           {} from one frame to the next, {} of it (frame {})\n",
                 newtons(force.step().value), percent(force.step_share()), force.step().frame);
  if (force.alternations() > 0) {
    fmt::format_to(out, "  alternations   {} within {:g} s\n", force.alternations(),
                   stability::ForceQuality::kWindowSeconds);
  }
  if (force.pull().frame >= 0) {
    fmt::format_to(out, "  pull           up to {} (frame {}): contact ends a pass late\n",
                   newtons(force.pull().value), force.pull().frame);
  }
  if (const std::optional<double> ripple = force.ripple(); ripple.value_or(0) > 0) {
    fmt::format_to(out, "  at rest        moves by {} peak to peak while the tip rests\n",
                   percent(*ripple));
  }
}

void strain_line(Out out, const fem::Strains& strain) {
  fmt::format_to(out,
                 "  strain         up to {}, {} of the volume beyond {}; {} turned inside out\n",
                 percent(strain.largest), percent(strain.beyond_share), percent(fem::kLinearStrain),
                 counted(strain.inverted, "element"));
}

}  // namespace

std::string force_text(const Outcome& o) {
  std::string text;
  const Out out = std::back_inserter(text);
  if (o.contact.missed) {
    fmt::format_to(
        out, "\nContact      none in frame {}, though the tip was {} inside the body: no force\n",
        o.contact.missed->frame, readable_length(-o.contact.missed->distance));
  }
  if (!o.force || o.force->peak().frame < 0) return text;
  force_lines(out, *o.force, o.contact);
  for (std::size_t i = 1; i < o.forces.size(); ++i) {
    fmt::format_to(out, "  probe {}        largest {} (frame {}), step {} of it\n", i,
                   newtons(o.forces[i].peak().value), o.forces[i].peak().frame,
                   percent(o.forces[i].step_share()));
  }
  if (o.strain) strain_line(out, o.strain->worst);
  return text;
}

}  // namespace hvp::results
