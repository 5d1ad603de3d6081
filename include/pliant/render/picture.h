// What a picture shows: plain data, filled anew for every frame. Colours are sRGB with channels in [0, 1].
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
  /// A closed surface. The mesh holds world coordinates and must outlive the call that draws it.
  struct Body {
    const TriangleMesh* mesh = nullptr;
    Eigen::Vector3f color = {0.8f, 0.8f, 0.8f};
    const VecX<double>* values = nullptr;  ///< one a vertex; with a scale the body is coloured by them
  };

  /// What the colours of values mean (color_map.h), shown as a bar at the right; values beyond have the first
  /// or the last colour. A picture less than 160 pixels wide or 120 high has no room for the bar.
  struct Scale {
    std::string title;  ///< of digits, small letters and . , - + / ( ): "strain", "displacement (m)"
    double low = 0, high = 1;
  };

  /// The path of a point, hidden where bodies are in front of it. A path of one point is a dot.
  struct Track {
    std::vector<Eigen::Vector3d> points;  ///< world, metres
    Eigen::Vector3f color = {0.15f, 0.15f, 0.18f};
    float width = 2;  ///< pixels
  };

  /// A floor of constant height that receives shadows and fades into the background far from the camera's
  /// target.
  struct Ground {
    bool shown = true;
    double height = 0;  ///< z, metres
    double spacing =
        0;  ///< of the grid, metres; 0 picks 1, 2 or 5 times a power of ten; every fifth line is stronger
    Eigen::Vector3f color = {0.93f, 0.935f, 0.945f};  ///< where the key light reaches it
    Eigen::Vector3f grid_color = {0.60f, 0.64f, 0.70f};
  };

  /// One distant key light, which casts shadows, over an ambient light that differs between above and below.
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
  std::optional<Scale> scale;
  std::vector<Track> tracks;
  Ground ground;
  Lights lights;
  Camera camera;
  Background background;
};

/// The smallest box around all bodies and tracks; empty when there are none.
Eigen::AlignedBox3d bounds(const Picture& picture);

}  // namespace pliant
