// Masses of the nodes of tetrahedra, from a density per rest volume (kg/m^3): M_ab = int of density N_a N_b.
//   lumped       4 nodes: a quarter of each element to each corner (row sums); 10 nodes, whose row sums are
//                negative at corners: the diagonal of M scaled to the mass of the element (Hinton, Rock &
//                Zienkiewicz 1976), which costs them their order; 15 nodes: the weights of the element's own
//                rule
//   consistent   M itself, for modes
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include <pliant/local/nodes.h>

namespace pliant {

/// kg, one a node. elements: 4, 10 or 15 rows, else std::invalid_argument.
VecX<double> lumped_mass(const Nodes& rest, const Eigen::MatrixXi& elements, double density);

/// Entries over nodes, kg; the same for each direction.
std::vector<Eigen::Triplet<double>> consistent_mass(const Nodes& rest, const Eigen::MatrixXi& elements,
                                                    double density);

}  // namespace pliant
