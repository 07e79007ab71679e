#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "models/fit/tissue_newmark.h"
#include "models/fit/tissue_proxy.h"
#include "models/index.h"

namespace hvp::fit {
namespace {

template <std::size_t Fields>
class PressedPlace : private TissueNewmark<Fields> {
  using Base = TissueNewmark<Fields>;

 public:
  PressedPlace(const TissueSystem& system, const TissueBody& body, const ProxyPlaces& places,
               const ProxyTouch& touch, const TissueValues& values)
      : Base(system, body, values),
        places_(places),
        touch_(touch),
        young_modulus_(values.young_modulus) {}

  using Base::positive_definite;

  TissueForce run(const ProxyPlaces::Answer& answer, const ProxyPlaces::Answer& slope) {
    answer_ = &answer;
    slope_ = &slope;
    const std::size_t samples = touch_.place.size();
    // The last round is for the derivatives alone.
    const std::size_t rounds = Fields == 1 ? samples : samples + 1;
    TissueForce result;
    Press before;
    for (std::size_t i = 0; i < rounds; ++i) {
      predict();
      form_rhs();
      if constexpr (Fields > 1) {
        if (i > 0) drive_derivatives(before);
      }
      factors_.solve(next_);
      update();
      FieldRow<Fields> force = {};
      if constexpr (Fields > 1) {
        if (i > 0) press_derivatives(before, force);
      }
      if (i < samples) {
        before = press(i);
        result.force.push_back(touch_.direction.dot(before.force.force));
      }
      if constexpr (Fields > 1) {
        if (i > 0) keep_derivatives(force, result);
      }
    }
    return result;
  }

 private:
  using Base::by_poisson_;
  using Base::by_young_;
  using Base::factors_;
  using Base::form_rhs;
  using Base::keep_derivatives;
  using Base::next_;
  using Base::predict;
  using Base::step_;
  using Base::system_;
  using Base::update;

  // How the body answers at a place: A⁻¹·Cᵀ over the unknowns, a column for each component of the
  // force, and the inverse of C·A⁻¹·Cᵀ + S.
  struct Response {
    std::vector<FieldRow<3>> columns;
    Eigen::Matrix3d stiffness;
  };
  // What a sample has found.
  struct Press {
    std::size_t place = 0;
    ForceOnCone force;  // λ
    Eigen::Vector3d sticking = Eigen::Vector3d::Zero();
  };

  // A proxy that sticks has one. Of one that slides, each is needed until its sample's derivatives
  // are known.
  const Response& response(std::size_t place) {
    if (place_of_response_ == place) return response_;
    place_of_response_ = place;
    Response& made = response_;
    const ProxyPlaces::Place& at_place = places_.place(place);
    made.columns.assign(next_.size(), FieldRow<3>{});
    for (std::size_t k = 0; k < 3; ++k) {
      const int first = system_.first_unknown[at(at_place.corners[k])];
      const double weight = at_place.spot.weight[static_cast<Eigen::Index>(k)];
      if (first < 0 || weight == 0) continue;
      for (std::size_t c = 0; c < 3; ++c) made.columns[at(first) + c][c] = weight;
    }
    factors_.solve(made.columns);
    Eigen::Matrix3d compliance = answer_->coupling[place] / young_modulus_;
    for (std::size_t c = 0; c < 3; ++c) {
      compliance.col(static_cast<Eigen::Index>(c)) +=
          at_spot(at_place, [&](std::size_t unknown) { return made.columns[unknown][c]; });
    }
    made.stiffness = compliance.inverse();
    return made;
  }

  // C times what a function gives for each unknown.
  template <class Of>
  Eigen::Vector3d at_spot(const ProxyPlaces::Place& place, const Of& of) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const int first = system_.first_unknown[at(place.corners[k])];
      if (first < 0) continue;
      const double weight = place.spot.weight[static_cast<Eigen::Index>(k)];
      for (std::size_t c = 0; c < 3; ++c) {
        sum[static_cast<Eigen::Index>(c)] += weight * of(at(first) + c);
      }
    }
    return sum;
  }

  // Adds the share that a force at the place has in a field of this step.
  void add(const Response& response, const Eigen::Vector3d& force, std::size_t field) {
    for (std::size_t i = 0; i < response.columns.size(); ++i) {
      const FieldRow<3>& row = response.columns[i];
      const double moved = row[0] * force[0] + row[1] * force[1] + row[2] * force[2];
      Base::u_[i][field] += moved;
      Base::v_[i][field] += step_.v_of_next * moved;
      Base::a_[i][field] += step_.a_of_next * moved;
    }
  }

  Press press(std::size_t sample) {
    Press now;
    now.place = touch_.place[sample];
    const Response& of_place = response(now.place);
    const ProxyPlaces::Place& place = places_.place(now.place);
    const Eigen::Vector3d apart =
        touch_.tip_from_x[sample] -
        at_spot(place, [&](std::size_t unknown) { return Base::u_[unknown][kMotion]; });
    now.sticking = of_place.stiffness * apart;
    now.force = {now.sticking};
    if (touch_.slides[sample]) now.force = put_on_cone(now.sticking, place.normal, touch_.friction);
    add(of_place, now.force.force, kMotion);
    return now;
  }

  // What form_rhs() has as M·(ü + α·u̇) stands for −K·(u + β·u̇), which contact makes that less Cᵀλ.
  void drive_derivatives(const Press& before) {
    const ProxyPlaces::Place& place = places_.place(before.place);
    for (std::size_t k = 0; k < 3; ++k) {
      const int first = system_.first_unknown[at(place.corners[k])];
      if (first < 0) continue;
      const double weight = place.spot.weight[static_cast<Eigen::Index>(k)];
      for (std::size_t c = 0; c < 3; ++c) {
        const double load = weight * before.force.force[static_cast<Eigen::Index>(c)];
        next_[at(first) + c][kYoung] -= by_young_ * load;
        next_[at(first) + c][kPoisson] -= by_poisson_ * load;
      }
    }
  }

  void press_derivatives(const Press& before, FieldRow<Fields>& force) {
    const ProxyPlaces::Place& place = places_.place(before.place);
    for (const std::size_t field : {kYoung, kPoisson, kAlpha, kBeta}) {
      Eigen::Vector3d change =
          at_spot(place, [&](std::size_t unknown) { return Base::u_[unknown][field]; });
      if (field == kYoung) {
        change -=
            answer_->coupling[before.place] * before.sticking / (young_modulus_ * young_modulus_);
      } else if (field == kPoisson) {
        change += slope_->coupling[before.place] * before.sticking / young_modulus_;
      }
      const Eigen::Vector3d by = -(before.force.by_force * (response_.stiffness * change));
      add(response_, by, field);
      force[field] = touch_.direction.dot(by);
    }
  }

  const ProxyPlaces& places_;
  const ProxyTouch& touch_;
  const ProxyPlaces::Answer* answer_ = nullptr;
  const ProxyPlaces::Answer* slope_ = nullptr;
  double young_modulus_;
  std::optional<std::size_t> place_of_response_;
  Response response_;
};

template <std::size_t Fields>
std::optional<TissueForce> integrate_pressed(const TissueSystem& system, const TissueBody& body,
                                             const ProxyPlaces& places, const ProxyTouch& touch,
                                             const TissueValues& values) {
  const ProxyPlaces::Answer* answer = places.answer(values.poisson_ratio);
  std::optional<ProxyPlaces::Answer> slope;
  if (Fields > 1) slope = places.slope(values.poisson_ratio);
  if (answer == nullptr || (Fields > 1 && !slope)) return std::nullopt;
  PressedPlace<Fields> pressed(system, body, places, touch, values);
  if (!pressed.positive_definite()) return std::nullopt;
  return pressed.run(*answer, slope.value_or(ProxyPlaces::Answer{}));
}

}  // namespace

std::optional<TissueForce> dynamic_proxy_force(const TissueSystem& system, const TissueBody& body,
                                               const ProxyPlaces& places, const ProxyTouch& touch,
                                               const TissueValues& values, bool derivatives) {
  return derivatives ? integrate_pressed<kFields>(system, body, places, touch, values)
                     : integrate_pressed<1>(system, body, places, touch, values);
}

}  // namespace hvp::fit
