// A scene: a MultiBody, the settings of its simulation (end, step, integrator) and the settings of its
// pictures. read_scene() makes a Scene from a JSON document.
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

/// Appearance of a part. A scene has one per part, in the order of MultiBody::parts().
struct Appearance {
  Color color{0.8, 0.5, 0.2};
  int resolution = 8;  ///< edges of the surface mesh along an eighth of a circle (class Surface)
  bool visible = true;
};

/// Appearance of an obstacle and its mesh file. A scene has one per obstacle, in the order of the MultiBody.
struct ObstacleLook {
  Color color{0.6, 0.58, 0.53};
  bool visible = true;
  MeshFile mesh;  ///< as stored in the file, before scaling and placement; empty for a plate
};

/// A rectangle centred at the point of a contact plane; pictures and meshes show it while the plane acts. Its
/// width is horizontal (along x for a horizontal plane).
struct PlaneLook {
  std::size_t plane = 0;         ///< index of the plane in the MultiBody
  double width = 1, height = 1;  ///< m
  Color color{0.6, 0.58, 0.53};
};

/// A material point whose path is drawn and recorded (Fig. 6b of the paper).
struct Track {
  std::string name;
  Point point;
  Color color{0.9, 0.2, 0.1};
};

struct CameraSetting {
  std::optional<Vec3<double>> eye, target;  ///< positions, m, world; chosen from the motion when absent
  double field_of_view = 35;                ///< vertical, degrees
};

struct LightSetting {
  std::optional<Vec3<double>> direction;  ///< unit vector towards the light; a default when absent
  bool shadows = true;
};

struct GroundSetting {
  bool visible = true;
  std::optional<double>
      height;  ///< z of the ground, m; just below the lowest point of the motion when absent
};

/// The integrator of a scene that gives a step, but no integrator and no tolerance: the method of the paper.
/// Other scenes without an integrator use kAutomatic, with kStandardTolerance if they give no tolerance.
inline constexpr const char* kFixedStepIntegrator = "semi_implicit_euler";

struct Scene {
  std::string name;         ///< given in the scene, or the file name without its extension
  std::string description;  ///< the behaviour that the scene demonstrates
  MultiBody body;
  std::vector<Appearance> appearance;
  std::vector<ObstacleLook> obstacles;
  std::vector<PlaneLook> planes;  ///< visible planes only
  std::vector<Track> tracks;

  double end = 1;      ///< end time of the run, s
  double step = 1e-3;  ///< fixed time step, s; ignored if tolerance > 0
  double tolerance =
      0;  ///< bound on the error of a step, see Simulation; 0: fixed steps without error control
  std::string integrator = kFixedStepIntegrator;
  double frame_rate = 25;  ///< recorded states and pictures per second
  /// Whether trajectory.csv has columns for every part and joint; when absent, only for up to
  /// TrajectoryTable::kMaxParts parts.
  std::optional<bool> every_part;
  bool contacts = false;          ///< whether a run records contacts and their impulses
  int width = 640, height = 480;  ///< size of pictures, pixels
  CameraSetting camera;
  LightSetting light;
  GroundSetting ground;
  std::optional<Coloring> coloring;  ///< when absent, parts have their own colours
  bool show_springs = true;          ///< whether pictures show springs as lines between their points

  std::string document;                ///< text of the file; a run stores it with its recording
  std::vector<std::string> overrides;  ///< assignments "/json/pointer=value" applied to the document
  std::uint64_t hash = 0;              ///< hash of document, overrides and mesh files; checked on resume
};

}  // namespace pliant
