// Masses of the nodes of tetrahedra, M_ab = int of density N_a N_b over the rest volume.
//   lumped       4 nodes: each corner receives a quarter of the mass of the element (row sums of M).
//                10 nodes: the diagonal of M is scaled to the mass of the element (Hinton, Rock &
//                Zienkiewicz 1976), because row sums are negative at corners. Frequencies then converge with
//                second order; with the consistent mass they converge with fourth order.
//                15 nodes: weights of the nodal rule of the element (kEnrichedNodes in tetrahedron.h).
//   consistent   M, for modes, integrated with kTetrahedronMassRule (tetrahedron.h).
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include <pliant/local/nodes.h>

namespace pliant {

/// Returns the lumped mass of each node, kg. rest: positions of the nodes, m. elements: 4, 10 or 15 node
/// numbers in each column. density: kg/m^3. Throws std::invalid_argument for another number of rows.
VecX<double> lumped_mass(const Nodes& rest, const Eigen::MatrixXi& elements, double density);

/// Returns the entries of the consistent mass matrix over nodes, kg, which applies to each direction. The
/// arguments and errors are those of lumped_mass.
std::vector<Eigen::Triplet<double>> consistent_mass(const Nodes& rest, const Eigen::MatrixXi& elements,
                                                    double density);

}  // namespace pliant
