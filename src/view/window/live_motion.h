// The running simulation that a window shows.
#pragma once

#include <filesystem>

#include <pliant/render/track_lines.h>
#include <pliant/view/live_run.h>
#include <pliant/view/viewer.h>

#include "force_lines.h"
#include "motion.h"

namespace pliant {

class LiveMotion final : public Motion {
 public:
  LiveMotion(Scene& scene, const ViewOptions& options);

  bool refresh() override;
  StatePicture& shown() override { return shown_; }
  double time() const override { return snapshot_->state.time(); }
  double delay() const override { return snapshot_->delay; }
  bool plays() const override { return plays_; }
  void play(bool on) override;
  void step() override;
  void reset() override;
  void show_again() override;
  void color_by_strain(bool on) override;
  void toggle_forces() override;
  std::optional<std::string> grab(const Hit& hit) override;
  void drag_to(const Vec3<double>& position) override;
  void release() override;
  std::string save() override;
  void add_to_panel(const std::string& selected) override;
  void report(std::ostream& out) const override;

 private:
  void add_drag_line();
  void extend_tracks();
  void add_rest_values(const std::string& part);
  void add_stiffnesses(const std::string& part);
  void add_parameter_stiffnesses(const std::string& part);
  void add_drive_stiffnesses(const std::string& part);
  void add_local_stiffnesses(const std::string& part);

  Scene* scene_;
  ViewOptions options_;
  LiveRun run_;  // made before model_, because its constructor changes the parts
  std::vector<RestValue> rest_values_;
  std::vector<SpringStiffness> stiffnesses_;
  std::vector<ParameterStiffness> parameter_stiffnesses_;
  std::vector<DriveStiffness> drive_stiffnesses_;
  std::vector<LocalStiffness> local_stiffnesses_;
  Model model_;  // of the picture; the simulation has a separate model, which changes with every drag
  SurfacePoints points_;
  StatePicture shown_;
  std::vector<TrackLine> tracks_;
  double track_time_ = -1;  // of the last point of the tracks, s
  std::shared_ptr<const Snapshot> snapshot_;
  bool plays_ = false, fast_ = false, adds_gravity_;
  Vec3<double> first_gravity_;            // m/s^2; 0 if the user's gravity is added to the scene's gravity
  float drag_strength_ = 0, gravity_[3];  // logarithm to base 10 of the factor of the stiffness; m/s^2
  ForceLines forces_;
  double highest_ = 0, size_ = 1;  // largest value of the coloring so far; size of the scene at time 0, m
};

}  // namespace pliant
