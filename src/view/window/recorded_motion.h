// The recording that a window shows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <pliant/body/dynamics.h>
#include <pliant/io/contact_recording.h>
#include <pliant/io/run/wall_clock.h>
#include <pliant/render/film.h>
#include <pliant/view/viewer.h>

#include "force_lines.h"
#include "motion.h"

namespace pliant {

class RecordedMotion final : public Motion {
 public:
  RecordedMotion(Scene& scene, const Model& model, const Recording& recording);

  bool refresh() override;
  StatePicture& shown() override { return film_->shown(); }
  double time() const override { return time_; }
  double delay() const override { return 0; }
  bool plays() const override { return plays_; }
  void play(bool on) override;
  void step() override;
  void reset() override { show(first_); }
  void show_again() override { changed_ = true; }
  void color_by_strain(bool on) override;
  void toggle_forces() override;
  std::optional<std::string> grab(const Hit& hit) override;
  void drag_to(const Vec3<double>&) override {}
  void release() override {}
  std::string save() override { return "a recording is saved already"; }
  void add_to_panel(const std::string& selected) override;
  void report(std::ostream& out) const override;

 private:
  void show(double time);
  void add_forces();
  void evaluate_forces(std::int64_t row);

  Scene* scene_;
  const Model* model_;
  const Recording* recording_;
  std::unique_ptr<Film> film_;
  Dynamics dynamics_;
  std::optional<RecordedContacts> contacts_;  // not set if the run has not recorded contacts
  ForceLines forces_;
  std::int64_t forces_row_ = -1;  // recorded state of arrows_; -1: none
  ForceArrows arrows_;
  std::string fault_;           // message, if the forces cannot be computed
  double size_ = 1;             // of the scene at the start, m
  double first_, last_, time_;  // s
  bool plays_ = false, changed_ = true;
  WallClock::time_point advanced_ = WallClock::now();
};

}  // namespace pliant
