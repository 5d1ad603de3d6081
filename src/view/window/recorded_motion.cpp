#include "recorded_motion.h"

#include <algorithm>
#include <exception>
#include <ostream>

#include <imgui.h>

namespace pliant {

RecordedMotion::RecordedMotion(Scene& scene, const Model& model, const Recording& recording)
    : scene_(&scene),
      model_(&model),
      recording_(&recording),
      film_(std::make_unique<Film>(scene, model, recording)),
      dynamics_(model),
      contacts_(RecordedContacts::open(recording.folder())),
      first_(recording.time(0)),
      last_(recording.time(recording.rows() - 1)),
      time_(first_) {
  film_->at(time_);
  const Eigen::AlignedBox3d bodies = film_->shown().bounds(recording.state(0));
  if (!bodies.isEmpty()) size_ = bodies.diagonal().norm();
}

void RecordedMotion::show(double time) {
  time_ = std::clamp(time, first_, last_);
  plays_ = false;
  changed_ = true;
}

void RecordedMotion::play(bool on) {
  if (on && time_ >= last_) time_ = first_;
  plays_ = on;
  advanced_ = WallClock::now();
}

void RecordedMotion::step() {
  show(time_ + 1 / scene_->frame_rate);
}

bool RecordedMotion::refresh() {
  if (plays_) {
    time_ = std::min(last_, time_ + seconds_since(advanced_));
    advanced_ = WallClock::now();
    changed_ = true;
    plays_ = time_ < last_;
  }
  if (!changed_) return false;
  changed_ = false;
  film_->at(time_);
  if (forces_.shown().any()) add_forces();
  return true;
}

/// Adds the forces at the last recorded state, because the motion between two states is interpolated.
void RecordedMotion::add_forces() {
  std::int64_t row = 0, end = recording_->rows();
  while (end - row > 1) {
    const std::int64_t middle = row + (end - row) / 2;
    (recording_->time(middle) <= time_ ? row : end) = middle;
  }
  if (row != forces_row_) evaluate_forces(row);
  forces_.add(arrows_, size_, film_->shown().picture());
}

/// Computes the forces that are shown at a recorded state.
void RecordedMotion::evaluate_forces(std::int64_t row) {
  forces_row_ = row;
  arrows_ = {};
  fault_.clear();
  try {
    const State state = recording_->state(row);
    if (forces_.shown().contacts && contacts_)
      for (const RecordedContacts::Force& contact : contacts_->at(recording_->time(row)))
        if (contact.force.allFinite()) arrows_.contacts.push_back({contact.at, contact.force});
    if (forces_.shown().joints) arrows_.joints = joint_forces(dynamics_, state);
    if (forces_.shown().loads) arrows_.loads = load_forces(dynamics_, state);
  } catch (const std::exception& fault) {
    fault_ = fault.what();
  }
}

void RecordedMotion::toggle_forces() {
  forces_.toggle();
  forces_row_ = -1;
  changed_ = true;
}

void RecordedMotion::color_by_strain(bool on) {
  if (on)
    scene_->coloring = Coloring{};
  else
    scene_->coloring.reset();
  const Picture before = film_->shown().picture();
  const bool connectors = film_->shown().shows_connectors;
  film_ = std::make_unique<Film>(*scene_, *model_, *recording_);
  film_->shown().shows_connectors = connectors;
  film_->at(time_);
  film_->shown().picture().camera = before.camera;
  film_->shown().picture().edges = before.edges;
  changed_ = true;
}

std::optional<std::string> RecordedMotion::grab(const Hit& hit) {
  (void)hit;  // the parts of a recording cannot be dragged
  return {};
}

void RecordedMotion::add_to_panel(const std::string&) {
  auto time = static_cast<float>(time_);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##time", &time, static_cast<float>(first_), static_cast<float>(last_),
                         "t = %.3f s"))
    show(time);
  if (forces_.add_to_panel()) {
    forces_row_ = -1;
    changed_ = true;
  }
  if (!fault_.empty()) ImGui::TextWrapped("%s", fault_.c_str());
  if (forces_.shown().contacts && !contacts_ && scene_->body.contact.active)
    ImGui::TextWrapped(
        "contacts are not recorded; \"output\": {\"contacts\": true} in the scene records them");
  ImGui::Text("%lld states, %.3f s", static_cast<long long>(recording_->rows()), last_ - first_);
}

void RecordedMotion::report(std::ostream& out) const {
  out << "time " << time_ << " s, recorded to " << last_ << " s\n";
}

}  // namespace pliant
