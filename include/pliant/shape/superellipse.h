// The superellipse |x|^(2/eps) + |y|^(2/eps) = 1 of unit axes: its moments and its label, shared by the
// superquadrics.
#pragma once

#include <utility>

#include <pliant/math/scalar/signed_power.h>
#include <pliant/shape/shape.h>

namespace pliant {

/// Area and mean square of a coordinate over the unit superellipse (Beta functions, physics 1.3).
Section superellipse_section(double eps);

/// Cosine and sine of the material angle at which (C^eps, S^eps) points along (x, y); (1, 0) for the origin.
std::pair<Trig<double>, Trig<double>> superellipse_label(double x, double y, double eps);

/// (1 - |t|^(2/eps))^(eps/2), the half width of the unit superellipse at height t; gap = 1 - |t| for accuracy
/// there.
double superellipse_width(double t, double gap, double eps);

/// The panels of a whole circle, or of the half -pi/2 .. pi/2.
std::vector<Panel> circle_panels(double eps, bool dynamic_exponent);
std::vector<Panel> half_circle_panels(double eps, bool dynamic_exponent);

/// The panels of a section coordinate whose width follows the superellipse.
std::vector<SectionPanel> superellipse_section_panels(double eps);

}  // namespace pliant
