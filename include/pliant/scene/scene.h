// A scene: a MultiBody with how long and how to run it, and how to show it. read_scene() makes one from a
// JSON document.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pliant/body/multibody.h>
#include <pliant/scene/coloring.h>
#include <pliant/scene/mesh_file.h>

namespace pliant {

/// Red, green, blue in [0, 1], sRGB.
using Color = std::array<double, 3>;

/// How a part looks; one for each part of the body, in its order.
struct Appearance {
  Color color{0.8, 0.5, 0.2};
  int resolution = 8;  ///< of its Surface
  bool visible = true;
};

/// How an obstacle looks, and where its surface is from; one for each of the body's, in their order.
struct ObstacleLook {
  Color color{0.6, 0.58, 0.53};
  bool visible = true;
  MeshFile mesh;  ///< as the file has it, neither scaled nor placed; empty of a plate
};

/// A rectangle about the point of a plane, which pictures and meshes show while the plane is there. Its width
/// is level, along x of a level plane.
struct PlaneLook {
  std::size_t plane = 0;         ///< its number among the body's
  double width = 1, height = 1;  ///< m
  Color color{0.6, 0.58, 0.53};
};

/// A material point whose path is drawn and recorded (the paper's Fig. 6b).
struct Track {
  std::string name;
  Point point;
  Color color{0.9, 0.2, 0.1};
};

struct CameraSetting {
  std::optional<Vec3<double>> eye, target;  ///< m; chosen automatically when not given
  double field_of_view = 35;                ///< vertical, degrees
};

struct LightSetting {
  std::optional<Vec3<double>> direction;  ///< towards the light; a default when not given
  bool shadows = true;
};

struct GroundSetting {
  bool visible = true;
  std::optional<double> height;  ///< z of the ground, m; just below the lowest point when not given
};

struct Scene {
  std::string name;         ///< file name without its ending, or given
  std::string description;  ///< what the scene must show
  MultiBody body;
  std::vector<Appearance> appearance;
  std::vector<ObstacleLook> obstacles;
  std::vector<PlaneLook> planes;  ///< those that are shown
  std::vector<Track> tracks;

  double end = 1;        ///< s
  double step = 1e-3;    ///< s; of no meaning with a tolerance
  double tolerance = 0;  ///< of the error of a step, see Simulation; 0: it is not controlled
  std::string integrator = "semi_implicit_euler";
  double frame_rate = 25;          ///< recorded states and pictures per second
  std::optional<bool> every_part;  ///< whether the table of a run tells of every part, be they many or few
  bool contacts = false;           ///< whether a run tells what touches
  int width = 640, height = 480;   ///< of pictures
  CameraSetting camera;
  LightSetting light;
  GroundSetting ground;
  std::optional<Coloring> coloring;  ///< parts have their own colours when not given
  bool show_springs = true;          ///< in pictures, as lines between their points

  std::string document;                ///< the file as it was read; a run keeps it beside its recording
  std::vector<std::string> overrides;  ///< "/json/pointer=value", applied to it
  std::uint64_t hash = 0;              ///< of the resolved document (overrides included), for resuming
};

}  // namespace pliant
