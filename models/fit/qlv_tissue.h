#pragma once

#include <vector>

#include "models/fit/qlv_problem.h"
#include "models/fit/tissue_scenario.h"
#include "models/tissue/prony.h"

namespace hvp::fit {

// From a QLV fit, whose c and q belong to one indenter on one specimen, to a material: Fung's law
// (models/tissue/fung.h) and a Prony series. gᵢ and τᵢ are the fit's own, since they multiply any
// elastic force. E and b follow only with a model of the specimen.

// The part of the specimen that is strained, as a column with free sides (tissue::Column): the
// indenter's face and the tissue's height below it. The force goes with the area, so that one that
// is not known makes E unknown and leaves b as it is.
struct Specimen {
  double area_m2 = 0;
  double height_m = 0;
  double poisson_ratio = 0.45;
};

struct QlvTissue {
  double young_modulus_pa = 0;
  double poisson_ratio = 0;
  double exponent = 0;  // b
  std::vector<tissue::PronyTerm> prony;

  // The rms (N), over the log's samples, of its forces less the fit's.
  double deviation_n = 0;
};

// The E and b with which the column's forces along the log are closest to those of the fit, by
// least squares. `values` are QlvProblem's parameters. Throws InputError naming what is to blame:
// "elastic" for a power law, which has no stiffness at first touch, "area", "height" or
// "poisson_ratio"; std::invalid_argument where the fit has no value.
QlvTissue qlv_tissue(const QlvSettings& settings, const PressedLog& log,
                     const std::vector<double>& values, const Specimen& specimen);

// Its force (N) at each sample of the log, computed in frames of `frame_s` as a run does. `contact`
// (m) and `offset` (N) are the fit's.
std::vector<double> qlv_tissue_force(const QlvTissue& tissue, const Specimen& specimen,
                                     const PressedLog& log, double contact, double offset,
                                     double frame_s);

// The tables [object.material], without the density, and [object.model] of a scenario.
std::vector<ScenarioWord> scenario_words(const QlvTissue& tissue);

}  // namespace hvp::fit
