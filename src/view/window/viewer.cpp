#include "viewer.h"

#include <cmath>
#include <utility>

namespace pliant {
namespace {

/// Wall time without a change after which a picture of full quality is drawn, s.
constexpr double kStill = 0.25;
constexpr double kZoom = 1.15;  // factor of one notch of the wheel

}  // namespace

Viewer::Viewer(Motion& motion, GlContext::Loader loader)
    : motion_(motion), renderer_(std::move(loader)), by_strain_(motion.shown().picture().scale.has_value()) {}

void Viewer::resized(int width, int height) {
  width_ = width;
  height_ = height;
  changed_ = true;
}

void Viewer::mouse_moved(double x, double y) {
  const double dx = (x - x_) / height_, dy = (y_ - y) / height_;
  x_ = x;
  y_ = y;
  if (action_ == Action::none) return;
  if (action_ == Action::orbit) orbit(camera(), dx, dy);
  if (action_ == Action::pan) pan(camera(), dx, dy);
  if (action_ == Action::drag)
    motion_.drag_to(in_view_plane(camera(), ray_at(camera(), x, y, width_, height_), depth_));
  changed_ = true;
}

void Viewer::begin_drag_or_orbit() {
  action_ = Action::orbit;
  const StatePicture& shown = motion_.shown();
  const std::optional<Hit> hit = first_hit(shown.bodies(), ray_at(camera(), x_, y_, width_, height_));
  selected_ = hit ? shown.bodies()[hit->mesh].name : "";
  if (!hit || !motion_.grab(*hit)) return;
  action_ = Action::drag;
  depth_ = hit->position;
}

void Viewer::mouse_pressed(MouseButton button, bool with_shift) {
  if (action_ != Action::none) return;
  button_ = button;
  if (button == MouseButton::middle || (button == MouseButton::left && with_shift))
    action_ = Action::pan;
  else if (button == MouseButton::right)
    action_ = Action::orbit;
  else
    begin_drag_or_orbit();
}

void Viewer::mouse_released(MouseButton button) {
  if (button != button_) return;
  if (action_ == Action::drag) motion_.release();
  action_ = Action::none;
}

void Viewer::wheel_turned(double notches) {
  zoom(camera(), std::pow(kZoom, notches));
  changed_ = true;
}

void Viewer::key_pressed(const std::string& key) {
  if (key == "space") motion_.play(!motion_.plays());
  if (key == "s") motion_.step();
  if (key == "r") motion_.reset();
  if (key == "w") message_ = motion_.save();
  if (key == "f") motion_.toggle_forces();
  if (key == "c") color_by_strain(!by_strain_);
  StatePicture& shown = motion_.shown();
  if (key == "j") shown.shows_connectors = !shown.shows_connectors;
  if (key == "m") shown.picture().edges = !shown.picture().edges;
  if (key == "j" || key == "m") show_again();
}

void Viewer::color_by_strain(bool on) {
  by_strain_ = on;
  motion_.color_by_strain(on);
  changed_ = true;
}

void Viewer::show_again() {
  motion_.show_again();
  changed_ = true;
}

bool Viewer::draw() {
  const bool moved = motion_.refresh() || changed_;
  changed_ = false;
  if (moved) moved_ = WallClock::now();
  const bool becomes_full = !full_ && seconds_since(moved_) > kStill;
  if (!moved && !becomes_full) {
    renderer_.draw_again();
    return false;
  }
  full_ = !moved;
  renderer_.draw(motion_.shown().picture(), width_, height_,
                 full_ ? WindowRenderer::Quality::full : draft_.quality());
  return true;
}

void Viewer::add_picture_time(double seconds) {
  if (!full_) draft_.add(seconds);
}

bool Viewer::is_idle() const {
  return full_ && !motion_.plays();
}

}  // namespace pliant
