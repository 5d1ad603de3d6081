// The lines of forces in a picture, and their settings in the panel.
#pragma once

#include <pliant/render/picture.h>
#include <pliant/view/forces.h>

namespace pliant {

class ForceLines {
 public:
  const ShownForces& shown() const { return shown_; }
  /// Shows all kinds, or none.
  void toggle();
  /// Adds the settings to the panel of the window. Returns whether the user has changed a setting.
  bool add_to_panel();
  /// Adds a line for each force of the kinds that are shown, with a dot at its point. The line of the
  /// largest force so far has a quarter of the size of the scene. size: size of the scene, m.
  void add(const ForceArrows& arrows, double size, Picture& picture);

 private:
  void add(const std::vector<ForceArrow>& arrows, const Eigen::Vector3f& color, double scale,
           Picture& picture);

  ShownForces shown_;
  double largest_ = 0;  // N
};

/// Adds a line (m, world) that bodies do not hide. width: pixels.
void add_line(std::vector<Eigen::Vector3d> points, const Eigen::Vector3f& color, float width,
              Picture& picture);

}  // namespace pliant
