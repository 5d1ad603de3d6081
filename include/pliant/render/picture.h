// The content of a picture as plain data, which is set again for every frame. Colours are sRGB with channels
// in [0, 1].
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <pliant/math/types.h>
#include <pliant/part/mesh/triangle_mesh.h>
#include <pliant/render/camera.h>

namespace pliant {

struct Picture {
  /// The surface of a part, an obstacle or a plane: closed, or with triangles for both sides. The mesh has
  /// world coordinates (m) and must outlive the call that draws it.
  struct Body {
    const TriangleMesh* mesh = nullptr;
    Eigen::Vector3f color = {0.8f, 0.8f, 0.8f};
    const VecX<double>* values = nullptr;  ///< one for each vertex; with a scale, values set the colours
  };

  /// The range of values of the colour map (color_map.h), shown as a bar at the right. Values outside have
  /// the first or the last colour. Pictures narrower than 160 pixels or lower than 120 have no bar.
  struct Scale {
    std::string title;  ///< digits, small letters, blanks and . , - + / ( ), as in "displacement (m)"
    double low = 0, high = 1;
  };

  /// The path of a point in the world. A path of one point is drawn as a dot.
  struct Track {
    std::vector<Eigen::Vector3d> points;  ///< world, m
    Eigen::Vector3f color = {0.15f, 0.15f, 0.18f};
    float width = 2;      ///< pixels
    bool on_top = false;  ///< whether the path is visible behind bodies
  };

  /// A floor of constant height. It receives shadows and fades into the background far from the target of the
  /// camera.
  struct Ground {
    bool shown = true;
    double height = 0;  ///< z of the floor, m
    /// Spacing of the grid, m. If it is 0, the renderer chooses 1, 2 or 5 times a power of ten. Every fifth
    /// line is stronger.
    double spacing = 0;
    Eigen::Vector3f color = {0.93f, 0.935f, 0.945f};  ///< colour under the full light, without shadows
    Eigen::Vector3f grid_color = {0.60f, 0.64f, 0.70f};
  };

  /// One distant key light, which casts shadows, and an ambient light with different colours from above and
  /// below.
  struct Lights {
    Eigen::Vector3f to_key = {-0.28f, -0.52f, 0.81f};  ///< direction towards the key light, any length
    Eigen::Vector3f key = {1.0f, 0.975f, 0.94f};       ///< colour at full strength
    Eigen::Vector3f sky = {0.80f, 0.86f, 0.95f};       ///< ambient colour from above
    Eigen::Vector3f bounce = {0.62f, 0.60f, 0.58f};    ///< ambient colour from below
    float key_strength = 0.95f;
    float ambient_strength = 0.62f;
    bool shadows = true;
  };

  struct Background {
    Eigen::Vector3f top = {0.80f, 0.845f, 0.90f};
    Eigen::Vector3f bottom = {0.955f, 0.96f, 0.965f};
  };

  std::vector<Body> bodies;
  bool edges = false;  ///< whether the edges of the triangles of all bodies are drawn as dark lines
  std::optional<Scale> scale;
  std::vector<Track> tracks;
  Ground ground;
  Lights lights;
  Camera camera;
  Background background;
};

/// Returns the smallest box around all bodies and tracks; empty if there are none.
Eigen::AlignedBox3d bounds(const Picture& picture);

}  // namespace pliant
