#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "models/fem/assembly.h"
#include "models/fem/loads.h"
#include "models/fem/materials.h"
#include "models/fem/quadratic_element.h"
#include "models/mesh/tet_mesh.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The treatment of nodes with a prescribed displacement. `removed`: their unknowns leave the
// system. `kept`: they stay as rows and columns that are zero but for the diagonal, like a contact
// node's (thesis §3.7), so that node numbers do not change. Their diagonal is the mean over the
// free nodes, which keeps the condition number.
enum class AnchorTreatment { removed, kept };
const std::vector<std::pair<std::string_view, AnchorTreatment>>& anchor_treatment_names();

// The elastic system of a scene: K·u = f over the *active* nodes.
//
// Anchored nodes have u = 0, prescribed ones the u of the loads; held() is true for both, and both
// are treated alike. The columns of such a node, times its displacement, go to the right-hand side;
// its unknowns are removed, or kept with diagonal·u on the right.
class Body {
 public:
  // `anchored` ascends. Throws InputError for an inverted element, a node without elements, too few
  // held nodes (some part of the mesh keeps rigid-body modes; the message counts them), no free
  // node, a node that is both anchored and prescribed, or prescribed twice and differently, and a
  // load on held nodes alone.
  // The error's key is empty for the mesh, "anchor" for the anchors, otherwise that of the load.
  // `elements` other than linear need a quadratic mesh, linear ones a mesh that is not; throws
  // std::invalid_argument otherwise.
  Body(mesh::TetMesh mesh, const Materials& materials, std::span<const int> anchored,
       AnchorTreatment treatment, const Loads& loads = {}, Elements elements = Elements::linear);

  const mesh::TetMesh& mesh() const { return mesh_; }
  const Materials& materials() const { return materials_; }
  // Of a body of one material; std::logic_error of another.
  const Material& material() const;
  AnchorTreatment treatment() const { return treatment_; }
  Elements elements() const { return elements_; }

  int active_nodes() const { return static_cast<int>(node_of_active_.size()); }
  // The mesh node of each active node, ascending.
  const std::vector<int>& node_of_active() const { return node_of_active_; }
  // The active index of a mesh node, −1 if it was removed.
  int active_index(int node) const { return active_of_node_[static_cast<std::size_t>(node)]; }
  // True if the node is anchored or has a prescribed displacement.
  bool held(int node) const { return held_[static_cast<std::size_t>(node)]; }
  const std::vector<int>& anchored() const { return anchored_; }
  // The displacement of such a node, m; zero of others.
  Eigen::Vector3d held_displacement(int node) const {
    return Eigen::Vector3d(&held_displacement_[3 * static_cast<std::size_t>(node)]);
  }

  // K over the active nodes, N/m.
  const sparse::BlockMatrix& stiffness() const { return stiffness_; }
  // M over the active nodes, kg. Kept nodes have the free nodes' mean on the diagonal, so that the
  // same is true of Â.
  sparse::BlockMatrix mass(MassKind kind) const;
  // f over the active nodes, N.
  const std::vector<double>& load() const { return load_; }
  // The same without what K makes of the prescribed displacements: the load on a body whose forces
  // are not K·u. A kept node has its diagonal times its displacement.
  const std::vector<double>& dead_load() const { return dead_load_; }
  // The state to start from: zero, but for prescribed nodes that are kept, which have their
  // displacement. Newmark's integration leaves them there.
  std::vector<double> initial_displacement() const;

  // Displacements over all mesh nodes from those of the active ones; anchored and prescribed nodes
  // get theirs.
  void expand(std::span<const double> u_active, std::span<double> u_full) const;
  std::vector<double> expand(std::span<const double> u_active) const;

 private:
  void hold(std::span<const int> anchored, const Loads& loads);
  void move_prescribed_to_load(const sparse::BlockMatrix& full_stiffness,
                               std::span<const double> full_load);
  sparse::BlockMatrix reduce(const sparse::BlockMatrix& full) const;

  mesh::TetMesh mesh_;
  Materials materials_;
  AnchorTreatment treatment_;
  Elements elements_;
  std::vector<int> anchored_;
  std::vector<char> held_;
  std::vector<double> held_displacement_;  // three for each mesh node; zero if not prescribed
  std::vector<int> node_of_active_;
  std::vector<int> active_of_node_;
  sparse::BlockMatrix stiffness_;
  std::vector<double> load_;
  std::vector<double> dead_load_;
};

// The number of rigid-body modes of a connected part of the mesh whose `held_nodes` are fixed: 6
// without any, 3 with one node, 1 with nodes on one line, otherwise 0.
int remaining_rigid_body_modes(const mesh::TetMesh& mesh, std::span<const int> held_nodes);

}  // namespace hvp::fem
