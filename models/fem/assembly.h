#pragma once

#include "models/fem/element.h"
#include "models/fem/material.h"
#include "models/mesh/tet_mesh.h"
#include "models/sparse/block_matrix.h"

// Assemblage, thesis (3.19): element blocks are added up node pair by node pair, in the order of
// the elements. Time and memory grow linearly with the mesh. Each function throws InputError
// naming an element that is inverted or degenerate, and a node that no element holds.
namespace hvp::fem {

// The blocks of K over all nodes of the mesh, zero: a block wherever two nodes share an element.
sparse::BlockMatrix stiffness_pattern(const mesh::TetMesh& mesh);

// K in N/m over all nodes, without supports: six rigid-body modes. Symmetric to the last bit.
sparse::BlockMatrix assemble_stiffness(const mesh::TetMesh& mesh, const Material& material);

// M in kg over all nodes. Lumped: diagonal blocks only. Consistent: K's pattern.
sparse::BlockMatrix assemble_mass(const mesh::TetMesh& mesh, const Material& material,
                                  MassKind kind);

}  // namespace hvp::fem
