// The mass distribution mu(u) of Eq. (11) over the material points of a part.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include <pliant/shape/material.h>

namespace pliant {

class Part;

/// The mass density of material points, as a multiple of Part::density(). at: the material points. X: the
/// positions of these points at rest, body frame, m, one column for each point. The multiples must be finite
/// and not negative. M and g_q from the mass points are exact to rounding for distributions that are smooth
/// and vary slowly on each panel (shape/panel.h) of the shape. For other distributions,
/// MassPoints::relative_error estimates the error.
using MassDistribution =
    std::function<Eigen::VectorXd(const std::vector<Material<double>>& at, const Eigen::Matrix3Xd& X)>;

/// Returns the multiples at material points of a part at rest. Throws std::invalid_argument, with the name of
/// the part and the point, if a multiple is negative or not finite.
Eigen::VectorXd mass_multiples(const Part& part, const MassDistribution& distribution,
                               const std::vector<Material<double>>& at);

}  // namespace pliant
