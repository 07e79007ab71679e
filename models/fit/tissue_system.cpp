#include "models/fit/tissue_system.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/index.h"

namespace hvp::fit {
namespace {

fem::Body make_body(const TissueBody& body, double young_modulus, double poisson_ratio) {
  const fem::Material material{.young_modulus_pa = young_modulus,
                               .poisson_ratio = poisson_ratio,
                               .density_kg_m3 = body.density_kg_m3};
  return {body.mesh, material, body.anchored, fem::AnchorTreatment::removed};
}

// Approximate minimum degree: the nodes of a pattern in their new order. All three unknowns of a
// node stay together, so that their columns of the factors have one pattern.
std::vector<int> sparse_order(const sparse::BlockMatrix& pattern) {
  const int n = pattern.block_rows();
  const std::vector<double> one(pattern.blocks(), 1.0);
  const Eigen::SparseMatrix<double> nodes = Eigen::Map<const Eigen::SparseMatrix<double>>(
      n, n, static_cast<Eigen::Index>(one.size()), pattern.row_begin.data(), pattern.column.data(),
      one.data());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(nodes, order);
  return {order.indices().data(), order.indices().data() + n};
}

}  // namespace

Lame lame(double young_modulus, double poisson_ratio) {
  const double sum = 1 + poisson_ratio;
  const double gap = 1 - 2 * poisson_ratio;
  const LamePair unit = {poisson_ratio / (sum * gap), 1 / (2 * sum)};
  const LamePair slope = {(1 + 2 * poisson_ratio * poisson_ratio) / (sum * sum * gap * gap),
                          -1 / (2 * sum * sum)};
  return {{young_modulus * unit.lambda, young_modulus * unit.mu},
          unit,
          {young_modulus * slope.lambda, young_modulus * slope.mu}};
}

// Over the active nodes: K at λ = μ = 1 Pa, at λ = 0 and μ = 1 Pa, and M.
struct TissueSystem::Assembled {
  fem::Body body;
  sparse::BlockMatrix both;
  sparse::BlockMatrix mu;
  sparse::BlockMatrix mass;

  LamePair stiffness(std::size_t block, std::size_t entry) const {
    const double of_mu = mu.block(block)[entry];
    return {both.block(block)[entry] - of_mu, of_mu};
  }
  double mass_entry(int row, int col, std::size_t entry) const {
    if (mass.block_rows() == 0) return 0;
    const std::ptrdiff_t at = mass.find(row, col);
    return at < 0 ? 0 : mass.block(static_cast<std::size_t>(at))[entry];
  }
};

// E = 2.5, ν = ¼ gives λ = μ = 1; E = 2, ν = 0 gives λ = 0, μ = 1.
TissueSystem::Assembled TissueSystem::assemble(const TissueBody& body) {
  fem::Body both = make_body(body, 2.5, 0.25);
  sparse::BlockMatrix stiffness = both.stiffness();
  sparse::BlockMatrix mass;
  if (body.dynamics) mass = both.mass(body.dynamics->mass);
  return {std::move(both), std::move(stiffness), make_body(body, 2, 0).stiffness(),
          std::move(mass)};
}

TissueSystem::TissueSystem(const TissueBody& body)
    : lumped(body.dynamics && body.dynamics->mass == fem::MassKind::lumped) {
  reduce(assemble(body), {}, Eigen::Vector3d::Zero());
}

TissueSystem::TissueSystem(const TissueBody& body, std::span<const int> contact,
                           const Eigen::Vector3d& direction)
    : lumped(body.dynamics && body.dynamics->mass == fem::MassKind::lumped) {
  const Assembled full = assemble(body);
  const fem::Body& both = full.body;
  if (!direction.allFinite() || !(direction.norm() > 0)) {
    throw InputError("the contact's direction has no length; expected a vector such as 0 0 -1");
  }
  if (contact.empty()) throw InputError("the contact has no node; expected at least one");
  std::vector<int> active;
  for (const int node : contact) {
    if (node < 0 || at(node) >= body.mesh.nodes.size()) {
      throw InputError(fmt::format("contact_node is {}; expected 0 to {}", node,
                                   static_cast<std::ptrdiff_t>(body.mesh.nodes.size()) - 1));
    }
    if (both.held(node)) {
      throw InputError(fmt::format(
          "contact_node {} is anchored and cannot move; expected a node that is free", node));
    }
    active.push_back(both.active_index(node));
  }
  if (!std::ranges::is_sorted(active) || std::ranges::adjacent_find(active) != active.end()) {
    throw InputError("the contact's nodes do not ascend; expected each once, in order");
  }
  if (static_cast<int>(active.size()) == both.active_nodes()) {
    throw InputError("the contact holds every node that is free; expected some that it does not");
  }
  reduce(full, active, direction.normalized());
}

void TissueSystem::reduce(const Assembled& full, std::span<const int> contact,
                          const Eigen::Vector3d& direction) {
  const sparse::BlockMatrix& k = full.both;
  std::vector<int> free;
  std::vector<char> touched(at(k.block_rows()), 0);
  for (const int node : contact) touched[at(node)] = 1;
  for (int i = 0; i < k.block_rows(); ++i) {
    if (touched[at(i)] == 0) free.push_back(i);
  }
  const std::vector<int> order = sparse_order(k.submatrix(free));
  const std::size_t n = 3 * order.size();
  std::vector<int> place(at(k.block_rows()), -1);  // a node's first unknown; −1: touched
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[at(free[at(order[i])])] = static_cast<int>(3 * i);
  }
  first_unknown.assign(full.body.mesh().nodes.size(), -1);
  for (std::size_t i = 0; i < place.size(); ++i) {
    first_unknown[at(full.body.node_of_active()[i])] = place[i];
  }

  struct Entry {
    int column;
    LamePair stiffness;
    double mass;
  };
  std::vector<Entry> row;
  row_begin.assign(1, 0);
  diagonal.assign(lumped ? n : 0, 0.0);
  for (std::size_t unknown = 0; unknown < n; ++unknown) {
    const int node = free[at(order[unknown / 3])];
    const std::size_t r = unknown % 3;
    row.clear();
    Coupling to_contact{static_cast<int>(unknown), {}, 0};
    for (int b = k.row_begin[at(node)]; b < k.row_begin[at(node) + 1]; ++b) {
      const int other = k.column[at(b)];
      for (std::size_t c = 0; c < 3; ++c) {
        const LamePair value = full.stiffness(at(b), 3 * r + c);
        const double kg = full.mass_entry(node, other, 3 * r + c);
        if (touched[at(other)] == 0) {
          row.push_back({place[at(other)] + static_cast<int>(c), value, kg});
        } else {
          const double share = direction[static_cast<Eigen::Index>(c)];
          to_contact.stiffness.lambda += value.lambda * share;
          to_contact.stiffness.mu += value.mu * share;
          to_contact.mass += kg * share;
        }
      }
    }
    std::ranges::sort(row, {}, &Entry::column);
    for (const Entry& entry : row) {
      column.push_back(entry.column);
      stiffness.push_back(entry.stiffness);
      mass.push_back(entry.mass);
      if (lumped && entry.column == static_cast<int>(unknown)) diagonal[unknown] = entry.mass;
    }
    row_begin.push_back(static_cast<int>(column.size()));
    if (to_contact.stiffness.lambda != 0 || to_contact.stiffness.mu != 0 || to_contact.mass != 0) {
      coupling.push_back(to_contact);
    }
  }

  for (const int node : contact) {
    for (int b = k.row_begin[at(node)]; b < k.row_begin[at(node) + 1]; ++b) {
      const int other = k.column[at(b)];
      if (touched[at(other)] == 0) continue;
      for (std::size_t e = 0; e < 9; ++e) {
        const double share = direction[static_cast<Eigen::Index>(e / 3)] *
                             direction[static_cast<Eigen::Index>(e % 3)];
        const LamePair value = full.stiffness(at(b), e);
        contact_stiffness.lambda += value.lambda * share;
        contact_stiffness.mu += value.mu * share;
        contact_mass += full.mass_entry(node, other, e) * share;
      }
    }
  }
}

}  // namespace hvp::fit
