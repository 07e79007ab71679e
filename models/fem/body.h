#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "models/fem/element.h"
#include "models/fem/loads.h"
#include "models/fem/material.h"
#include "models/mesh/tet_mesh.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// What becomes of the nodes that are held. `removed`: their unknowns leave the system, which
// shrinks. `kept`: they stay as rows and columns that are cleared but for the diagonal, as a
// contact node's are (thesis §3.7), so that node numbers do not change. On the diagonal stands
// the mean over the free nodes, which keeps the condition number.
enum class AnchorTreatment { removed, kept };
const std::vector<std::pair<std::string_view, AnchorTreatment>>& anchor_treatment_names();

// A scene's elastic system: K·u = f over the *active* nodes.
//
// Held nodes are the anchored ones (u = 0) and the prescribed ones (u given by the loads). Both
// are treated alike: the columns of a prescribed node, times its displacement, go to the
// right-hand side; its own unknowns are removed, or kept with diagonal·u on the right.
class Body {
 public:
  // `anchored` ascends. Throws InputError: an inverted element, a node without elements, too few
  // held nodes (some part of the mesh keeps rigid-body modes; the message counts them), all nodes
  // held, a node both anchored and prescribed, or prescribed twice and differently, a load on
  // held nodes alone.
  // The key is empty for the mesh, "anchor" for what holds the body, that of the load otherwise.
  Body(mesh::TetMesh mesh, const Material& material, std::span<const int> anchored,
       AnchorTreatment treatment, const Loads& loads = {});

  const mesh::TetMesh& mesh() const { return mesh_; }
  const Material& material() const { return material_; }
  AnchorTreatment treatment() const { return treatment_; }

  int active_nodes() const { return static_cast<int>(node_of_active_.size()); }
  // Mesh nodes in the order of the active ones, ascending.
  const std::vector<int>& node_of_active() const { return node_of_active_; }
  // Active index of a mesh node, −1 where it was removed.
  int active_index(int node) const { return active_of_node_[static_cast<std::size_t>(node)]; }
  // Anchored or prescribed.
  bool held(int node) const { return held_[static_cast<std::size_t>(node)]; }
  const std::vector<int>& anchored() const { return anchored_; }

  // K over the active nodes, N/m.
  const sparse::BlockMatrix& stiffness() const { return stiffness_; }
  // M over the active nodes, kg. Kept nodes have the free nodes' mean on the diagonal, so that
  // Â's diagonal there is the mean of Â's.
  sparse::BlockMatrix mass(MassKind kind) const;
  // f over the active nodes, N.
  const std::vector<double>& load() const { return load_; }
  // The state to start from: zero, prescribed nodes that are kept at their displacement. Newmark
  // integration leaves held nodes where they start.
  std::vector<double> initial_displacement() const;

  // K and f over all mesh nodes before anything is held: for support forces and export.
  const sparse::BlockMatrix& full_stiffness() const { return full_stiffness_; }
  const std::vector<double>& full_load() const { return full_load_; }

  // Displacements over all mesh nodes from those of the active ones; held nodes get theirs.
  void expand(std::span<const double> u_active, std::span<double> u_full) const;
  std::vector<double> expand(std::span<const double> u_active) const;

 private:
  void hold(std::span<const int> anchored, const Loads& loads);
  void move_prescribed_to_load();
  sparse::BlockMatrix reduce(const sparse::BlockMatrix& full) const;

  mesh::TetMesh mesh_;
  Material material_;
  AnchorTreatment treatment_;
  std::vector<int> anchored_;
  std::vector<char> held_;
  std::vector<double> held_displacement_;  // three a mesh node; zero where not prescribed
  std::vector<int> node_of_active_;
  std::vector<int> active_of_node_;
  sparse::BlockMatrix full_stiffness_;
  std::vector<double> full_load_;
  sparse::BlockMatrix stiffness_;
  std::vector<double> load_;
};

// Rigid-body modes that the held nodes leave to a part of the mesh that they belong to: 6 without
// any, 3 with one node, 1 with nodes on one line, otherwise 0.
int remaining_rigid_body_modes(const mesh::TetMesh& mesh, std::span<const int> held_nodes);

}  // namespace hvp::fem
