// The picture of one state of a model.
#pragma once

#include <vector>

#include <pliant/body/placed_point.h>
#include <pliant/io/frame_meshes.h>
#include <pliant/render/picture.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// Fills a picture with the visible parts, obstacles and planes at a state, and with springs, rods and
/// strings as thin lines. Each point of a spring or a joint that is attached to the world is a dot.
/// Scene::show_springs switches these lines and dots off. The scene gives the light and the ground.
class StatePicture {
 public:
  /// scene, model: must outlive the object.
  StatePicture(const Scene& scene, const Model& model);

  /// Whether set() draws springs and joints.
  bool shows_connectors = true;

  /// Sets the bodies of the picture; its tracks are then the lines and dots of springs and joints.
  void set(const State& state);
  /// Makes the meshes again, after Scene::coloring has changed. The picture then has no scale.
  void color_again();
  /// The picture. The caller may change its camera, ground, scale and tracks. Its bodies refer to this
  /// object.
  Picture& picture() { return picture_; }
  const Picture& picture() const { return picture_; }

  /// Returns the bounding box of the bodies at a state, m, world.
  Eigen::AlignedBox3d bounds(const State& state) const { return meshes_.bounds(state); }
  /// Extends a box by the ends of springs and joints that are attached to the world and are not farther from
  /// the box `bodies` than its diagonal. time: s.
  void extend_to_anchors(double time, const Eigen::AlignedBox3d& bodies, Eigen::AlignedBox3d& box) const;
  /// Sets the camera and the ground. bodies: a box around the bodies; all: a box around everything that the
  /// camera shows; aspect: width / height of the picture. Camera and ground settings of the scene take
  /// precedence.
  void set_view(const Eigen::AlignedBox3d& bodies, const Eigen::AlignedBox3d& all, double aspect);
  /// Sets the scale of values. The scene must have a coloring. highest: the 99th percentile of the values of
  /// a state (FrameMeshes::high_value()), or the largest one of several states. If the coloring has no range,
  /// the scale goes from 0 to a round number that is not below `highest`.
  void set_scale(double highest);
  const FrameMeshes& meshes() const { return meshes_; }
  /// The meshes of the last state, in the order of the bodies of the picture.
  const std::vector<NamedMesh>& bodies() const { return *bodies_; }

 private:
  /// A spring or a joint as it is drawn.
  struct Connector {
    std::vector<PlacedPoint> ends;  ///< two points, or one for a joint without a second point
    bool line;                      ///< whether a line connects the ends
    const Joint* joint;             ///< nullptr for a spring
    const Spring* spring;           ///< nullptr for a joint
    bool acts_at(double t) const { return joint != nullptr ? joint->acts_at(t) : spring->acts_at(t); }
  };
  void build_connectors();
  void draw_connectors(const State& state);

  const Scene* scene_;
  const Model* model_;
  FrameMeshes meshes_;
  const std::vector<NamedMesh>* bodies_ = nullptr;
  std::vector<Connector> connectors_;
  Picture picture_;
};

/// Returns the sRGB colour of a picture for a colour of a scene.
Eigen::Vector3f picture_color(const Color& color);

}  // namespace pliant
