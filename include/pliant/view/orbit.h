// Movements of a camera by the mouse, and rays through pixels.
#pragma once

#include <pliant/math/types.h>
#include <pliant/render/camera.h>

namespace pliant {

/// A half line. The direction is a unit vector, world.
struct Ray {
  Vec3<double> origin, direction;
};

/// Turns the eye about the target: about the axis `up` by -dx half turns, and down by dy half turns, at most
/// to 1 degree from this axis. The scene then follows the mouse. dx, dy: movement of the mouse to the right
/// and up, as a share of the height of the window.
void orbit(Camera& camera, double dx, double dy);
/// Moves eye and target, so that a point at the distance of the target follows the mouse. dx, dy: as in
/// orbit().
void pan(Camera& camera, double dx, double dy);
/// Divides the distance of the eye from the target by a factor > 0.
void zoom(Camera& camera, double factor);

/// Returns the ray from the eye through a point of the window: x, y pixels from its top left corner; width,
/// height: its size, pixels.
Ray ray_at(const Camera& camera, double x, double y, int width, int height);
/// Returns the point of a ray in the plane through a point (m, world) that is perpendicular to the view.
Vec3<double> in_view_plane(const Camera& camera, const Ray& ray, const Vec3<double>& point);
/// Returns the place of a point (m, world) in the window, pixels from its top left corner, and its distance
/// from the eye along the view, m.
Vec3<double> place_in_window(const Camera& camera, const Vec3<double>& point, int width, int height);

}  // namespace pliant
