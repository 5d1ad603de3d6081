// The superellipse |x|^(2/eps) + |y|^(2/eps) = 1 with unit axes: its moments, its inverse map and its
// quadrature panels, shared by the superquadrics.
#pragma once

#include <utility>

#include <pliant/math/scalar/signed_power.h>
#include <pliant/shape/shape.h>

namespace pliant {

/// Returns the section of a solid that is the unit superellipse. With the Beta function B, the area is
/// eps B(eps/2, eps/2), and both mean squares are (eps/2) B(3 eps/2, eps/2) / area (Jaklic, Leonardis and
/// Solina 2000).
Section superellipse_section(double eps);

/// Returns the cosine C and the sine S of the material angle at which (C^eps, S^eps) points along (x, y). For
/// the origin it returns (1, 0).
std::pair<Trig<double>, Trig<double>> superellipse_label(double x, double y, double eps);

/// Returns (1 - |t|^(2/eps))^(eps/2), the half width of the unit superellipse at height t. gap: 1 - |t|,
/// given separately because 1 - |t| is inaccurate near |t| = 1.
double superellipse_width(double t, double gap, double eps);

/// Returns the panels of a material angle over the whole circle: one periodic panel if eps is frozen at 1,
/// otherwise eight power panels. eps: exponent of the superellipse; dynamic_exponent: whether eps is a degree
/// of freedom.
std::vector<Panel> circle_panels(double eps, bool dynamic_exponent);
/// Returns the panels of a material angle from -pi/2 to pi/2: one smooth panel if eps is frozen at 1,
/// otherwise four power panels.
std::vector<Panel> half_circle_panels(double eps, bool dynamic_exponent);

/// Returns the intervals of zeta = z / h for a shape whose sections have the width
/// superellipse_width(zeta, 1 - |zeta|, eps).
std::vector<SectionPanel> superellipse_section_panels(double eps);

}  // namespace pliant
