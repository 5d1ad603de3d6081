// The inputs of a window, and the pictures that follow from them. GLFW and scripts call the same functions.
#pragma once

#include <memory>
#include <string>

#include <pliant/io/format/image.h>
#include <pliant/io/run/wall_clock.h>
#include <pliant/render/window_renderer.h>
#include <pliant/view/draft_quality.h>

#include "motion.h"

namespace pliant {

enum class MouseButton { left, middle, right };

class Viewer {
 public:
  /// The context of the window must be current. motion: must outlive the object.
  Viewer(Motion& motion, GlContext::Loader loader);

  // Places are in pixels from the top left corner of the window.
  void mouse_moved(double x, double y);
  /// with_shift: whether the key Shift is held.
  void mouse_pressed(MouseButton button, bool with_shift);
  void mouse_released(MouseButton button);
  /// Turns the wheel by a number of notches, positive away from the user.
  void wheel_turned(double notches);
  /// key: "space" plays or pauses, "s" makes one step, "r" resets, "w" saves; "c", "f", "j" and "m" switch
  /// strain colours, forces, joints and springs, and meshes on and off.
  void key_pressed(const std::string& key);
  void resized(int width, int height);

  /// Draws a new picture if the motion, the camera or a setting has changed, else shows the last picture
  /// again. Returns whether the picture is new. The panel is drawn after the picture.
  bool draw();
  void add_panel();
  /// Counts the wall time of the last new picture and its panel (s), which determines the quality of later
  /// pictures.
  void add_picture_time(double seconds);
  /// Whether the next call of draw() can wait for an input.
  bool is_idle() const;
  const std::string& selected() const { return selected_; }
  WindowRenderer& renderer() { return renderer_; }
  WindowRenderer::Quality draft() const { return draft_.quality(); }  ///< of pictures of a motion
  int width() const { return width_; }
  int height() const { return height_; }
  Motion& motion() { return motion_; }
  const Motion& motion() const { return motion_; }

 private:
  enum class Action { none, orbit, pan, drag };
  Camera& camera() { return motion_.shown().picture().camera; }
  void begin_drag_or_orbit();
  void color_by_strain(bool on);
  void show_again();
  void add_color_bar();
  void add_part_list();

  Motion& motion_;
  WindowRenderer renderer_;
  int width_ = 0, height_ = 0;
  double x_ = 0, y_ = 0;
  Action action_ = Action::none;
  MouseButton button_ = MouseButton::left;
  Vec3<double> depth_ = Vec3<double>::Zero();  // the dragged point at the start of the drag, m
  std::string selected_, message_;             // name of the part that was clicked last
  DraftQuality draft_;
  bool by_strain_ = false, changed_ = true, full_ = false;
  WallClock::time_point moved_ = WallClock::now();  // last change of the picture
};

}  // namespace pliant
