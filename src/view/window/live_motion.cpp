#include "live_motion.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <limits>
#include <ostream>
#include <thread>
#include <utility>

#include <imgui.h>

#include <pliant/io/run/run.h>
#include <pliant/view/save_scene.h>

namespace pliant {
namespace {

const Eigen::Vector3f kDragColor(0.85f, 0.15f, 0.1f);
constexpr float kDragWidth = 2.5f, kTargetWidth = 8;  // pixels
constexpr float kSliderWidth = 130;                   // pixels
constexpr double kFarther = 1.5;           // distance of the automatic camera / distance that fits time 0
constexpr double kTrackResolution = 1e-3;  // distance between two points of a track, in sizes of the scene

/// Returns the number of threads for the simulation: one processor is left to the window.
int threads_of(Scene& scene, int asked) {
  if (asked > 0) return asked;
  const int spare = static_cast<int>(std::thread::hardware_concurrency()) - 1;
  return std::clamp(automatic_threads(scene), 1, std::max(1, spare));
}

/// Adds a slider below its label. The label may be longer than the panel; a tooltip then shows the whole
/// label. Returns whether the user moved the slider.
bool add_slider(const std::string& label, float& value, float low, float high, const char* format,
                ImGuiSliderFlags flags = 0) {
  ImGui::TextUnformatted(label.c_str());
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", label.c_str());
  return ImGui::SliderFloat(("##" + label).c_str(), &value, low, high, format,
                            flags | ImGuiSliderFlags_AlwaysClamp);
}

}  // namespace

LiveMotion::LiveMotion(Scene& scene, const ViewOptions& options)
    : scene_(&scene),
      options_(options),
      run_(scene, 60, threads_of(scene, options.threads)),
      model_(scene.body),
      points_(scene, model_),
      shown_(scene, model_),
      snapshot_(run_.snapshot()),
      adds_gravity_(scene.body.changing_gravity.has_value()),
      first_gravity_(adds_gravity_ ? Vec3<double>(Vec3<double>::Zero()) : scene.body.gravity) {
  for (int i = 0; i < 3; ++i) gravity_[i] = static_cast<float>(first_gravity_[i]);
  run_.wait_for([&](LiveSimulation& simulation) {
    rest_values_ = simulation.rest_values();
    stiffnesses_ = simulation.stiffnesses();
    parameter_stiffnesses_ = simulation.parameter_stiffnesses();
    drive_stiffnesses_ = simulation.drive_stiffnesses();
    local_stiffnesses_ = simulation.local_stiffnesses();
  });
  show_again();
  const State& state = snapshot_->state;
  Eigen::AlignedBox3d bodies = shown_.bounds(state), all = bodies;
  shown_.extend_to_anchors(state.time(), bodies, all);
  if (!all.isEmpty()) size_ = all.diagonal().norm();
  shown_.set_view(bodies, all, static_cast<double>(options.width) / options.height);
  if (!scene.camera.eye) zoom(shown_.picture().camera, 1 / kFarther);
}

bool LiveMotion::refresh() {
  std::shared_ptr<const Snapshot> newest = run_.snapshot();
  plays_ = newest->running;
  if (newest == snapshot_) return false;
  snapshot_ = std::move(newest);
  extend_tracks();
  show_again();
  return true;
}

void LiveMotion::show_again() {
  shown_.set(snapshot_->state);
  if (scene_->coloring) {
    highest_ = std::max(highest_, shown_.meshes().high_value(snapshot_->state).value_or(0));
    shown_.set_scale(highest_);
  }
  for (const TrackLine& track : tracks_) shown_.picture().tracks.push_back(track.until(snapshot_->state));
  forces_.add(snapshot_->forces, size_, shown_.picture());
  add_drag_line();
}

/// Extends the lines of the tracks to the newest state. After a reset they start again.
void LiveMotion::extend_tracks() {
  for (const TrackSample& sample : run_.take_track_samples()) {
    if (!(sample.time > track_time_)) tracks_.clear();
    track_time_ = sample.time;
    if (tracks_.empty())
      for (const Track& track : scene_->tracks) tracks_.emplace_back(model_, track);
    for (std::size_t i = 0; i < tracks_.size(); ++i)
      tracks_[i].append(sample.time, sample.points[i], kTrackResolution * size_);
  }
}

void LiveMotion::add_drag_line() {
  if (!snapshot_->dragging) return;
  Picture& picture = shown_.picture();
  add_line({snapshot_->held, snapshot_->target}, kDragColor, kDragWidth, picture);
  add_line({snapshot_->target}, kDragColor, kTargetWidth, picture);
  add_line({snapshot_->held}, kDragColor, kTargetWidth, picture);
}

void LiveMotion::play(bool on) {
  on ? run_.play() : run_.pause();
}

void LiveMotion::step() {
  run_.step_once();
}

void LiveMotion::reset() {
  run_.reset();
  for (RestValue& rest : rest_values_) rest.next = rest.first;
  for (SpringStiffness& stiffness : stiffnesses_) stiffness.next = stiffness.first;
  for (ParameterStiffness& stiffness : parameter_stiffnesses_) stiffness.next = stiffness.first;
  for (DriveStiffness& stiffness : drive_stiffnesses_) stiffness.next = stiffness.first;
  for (LocalStiffness& stiffness : local_stiffnesses_) stiffness.next = 1;
  for (int i = 0; i < 3; ++i) gravity_[i] = static_cast<float>(first_gravity_[i]);
}

void LiveMotion::color_by_strain(bool on) {
  if (on)
    scene_->coloring = Coloring{};
  else
    scene_->coloring.reset();
  highest_ = 0;
  shown_.color_again();
  show_again();
}

void LiveMotion::toggle_forces() {
  forces_.toggle();
  run_.show_forces(forces_.shown());
}

std::optional<std::string> LiveMotion::grab(const Hit& hit) {
  const std::optional<Point> point = points_.at(hit);
  if (!point || point->part->fixed()) return {};
  SpringConstants spring = drag_spring(*point->part);
  const double factor = std::pow(10.0, drag_strength_);
  spring.stiffness *= factor;
  spring.damping *= std::sqrt(factor);
  run_.post([point = *point, spring](LiveSimulation& simulation) {
    simulation.grab(point, spring.stiffness, spring.damping);
  });
  return point->part->name();
}

void LiveMotion::drag_to(const Vec3<double>& position) {
  run_.post([position](LiveSimulation& simulation) { simulation.drag_to(position); });
}

void LiveMotion::release() {
  run_.post([](LiveSimulation& simulation) { simulation.release(); });
}

std::string LiveMotion::save() {
  run_.post_report([options = options_](LiveSimulation& simulation) {
    const std::string text = saved_scene(simulation, options.scene_folder, options.saved.parent_path());
    std::ofstream file(options.saved);
    return ((file << text).flush() ? "saved in " : "cannot write ") + options.saved.string();
  });
  return {};  // the next snapshots have the text
}

void LiveMotion::add_to_panel(const std::string& selected) {
  const Snapshot& now = *snapshot_;
  ImGui::Text("t = %.3f s", now.state.time());
  if (!now.running)
    ImGui::TextUnformatted("paused");
  else if (now.speed > 0)
    ImGui::Text("%.2f x real time", now.speed);
  else
    ImGui::TextUnformatted("plays");
  for (const std::string* text : {&now.failure, &now.refusal, &now.report})
    if (!text->empty()) ImGui::TextWrapped("%s", text->c_str());
  if (ImGui::Checkbox("as fast as possible", &fast_))
    run_.set_max_speed(fast_ ? std::numeric_limits<double>::infinity() : 1);
  ImGui::PushItemWidth(kSliderWidth);
  ImGui::SliderFloat("drag stiffness", &drag_strength_, -2, 3, "10^%.1f");
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("factor of the stiffness of the next drag");
  if (ImGui::SliderFloat3(adds_gravity_ ? "added gravity" : "gravity", gravity_, -20, 20, "%.1f")) {
    const Vec3<double> wanted(gravity_[0], gravity_[1], gravity_[2]);
    run_.post([wanted](LiveSimulation& simulation) { simulation.set_gravity(wanted); });
  }
  add_rest_values(selected);
  add_parameter_stiffnesses(selected);
  add_drive_stiffnesses(selected);
  add_local_stiffnesses(selected);
  add_stiffnesses(selected);
  ImGui::PopItemWidth();
  if (forces_.add_to_panel()) run_.show_forces(forces_.shown());
  ImGui::Separator();
  const Ledger& ledger = now.ledger;
  ImGui::Text("energy %.4g J", ledger.energy());
  ImGui::Text("work of anchors %.4g J", ledger.work[static_cast<int>(Work::anchors)]);
  ImGui::Text("balance %.2g J", ledger.balance);
}

/// Adds a slider for each rest value of a part. The slider of a positive parameter goes from 0.3 to 2 times
/// its first value, the slider of another parameter from -2 to 2 times this value, or from -1 to 1 if this
/// value is zero.
void LiveMotion::add_rest_values(const std::string& part) {
  for (std::size_t i = 0; i < rest_values_.size(); ++i) {
    RestValue& rest = rest_values_[i];
    if (rest.part->name() != part) continue;
    const double a = rest.first == 0 ? -1 : (rest.range.min > 0 ? 0.3 : -2) * rest.first,
                 b = rest.first == 0 ? 1 : 2 * rest.first;
    const auto low = static_cast<float>(std::clamp(std::min(a, b), rest.range.min, rest.range.max)),
               high = static_cast<float>(std::clamp(std::max(a, b), rest.range.min, rest.range.max));
    auto value = static_cast<float>(rest.next);
    if (!add_slider(rest.parameter, value, low, high, "%.3f")) continue;
    rest.next = std::clamp<double>(value, rest.range.min, rest.range.max);
    run_.post([i, wanted = rest.next](LiveSimulation& simulation) { simulation.set_rest_value(i, wanted); });
  }
}

/// Adds a slider for the stiffness of each parameter of a part, from a hundredth of its first value, or the
/// smallest value that is allowed, to the largest stiffness with stable steps.
void LiveMotion::add_parameter_stiffnesses(const std::string& part) {
  for (std::size_t i = 0; i < parameter_stiffnesses_.size(); ++i) {
    ParameterStiffness& stiffness = parameter_stiffnesses_[i];
    const RestValue& rest = rest_values_[stiffness.rest];
    if (rest.part->name() != part) continue;
    auto value = static_cast<float>(stiffness.next);
    const auto first = static_cast<float>(stiffness.first);
    const float low = std::max(0.01f * first, static_cast<float>(stiffness.least));
    if (!add_slider("stiffness of " + rest.parameter, value, low, static_cast<float>(stiffness.most), "%.4g",
                    ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoRoundToFormat))
      continue;
    stiffness.next = std::clamp<double>(value, stiffness.least, stiffness.most);  // the value may be rounded
    run_.post([i, wanted = stiffness.next](LiveSimulation& simulation) {
      simulation.set_parameter_stiffness(i, wanted);
    });
  }
}

/// Adds a slider for the stiffness of each drive of a parameter of a part, from a tenth of its first value to
/// the largest stiffness with stable steps.
void LiveMotion::add_drive_stiffnesses(const std::string& part) {
  for (std::size_t i = 0; i < drive_stiffnesses_.size(); ++i) {
    DriveStiffness& stiffness = drive_stiffnesses_[i];
    if (stiffness.part->name() != part) continue;
    auto value = static_cast<float>(stiffness.next);
    if (!add_slider("drive stiffness of " + stiffness.parameter, value,
                    0.1f * static_cast<float>(stiffness.first), static_cast<float>(stiffness.most), "%.4g",
                    ImGuiSliderFlags_Logarithmic))
      continue;
    stiffness.next = std::min<double>(value, stiffness.most);  // as a float, `most` may be larger
    run_.post([i, wanted = stiffness.next](LiveSimulation& simulation) {
      simulation.set_drive_stiffness(i, wanted);
    });
  }
}

/// Adds a slider for the factor of the local stiffness of a part, from 0.01 to the largest stable factor.
void LiveMotion::add_local_stiffnesses(const std::string& part) {
  for (std::size_t i = 0; i < local_stiffnesses_.size(); ++i) {
    LocalStiffness& stiffness = local_stiffnesses_[i];
    if (stiffness.part->name() != part) continue;
    auto value = static_cast<float>(stiffness.next);
    if (!add_slider("local stiffness", value, 0.01f, static_cast<float>(stiffness.most), "%.3g x",
                    ImGuiSliderFlags_Logarithmic))
      continue;
    stiffness.next = std::min<double>(value, stiffness.most);  // as a float, `most` may be larger
    run_.post([i, wanted = stiffness.next](LiveSimulation& simulation) {
      simulation.set_local_stiffness(i, wanted);
    });
  }
}

/// Adds a slider for the stiffness of each spring at a part, from a tenth of its first value to the largest
/// stiffness with stable steps.
void LiveMotion::add_stiffnesses(const std::string& part) {
  const auto is_at = [&](const Point& end) { return end.part != nullptr && end.part->name() == part; };
  for (std::size_t i = 0; i < stiffnesses_.size(); ++i) {
    SpringStiffness& stiffness = stiffnesses_[i];
    const Spring& spring = *stiffness.spring;
    if (!is_at(spring.a) && !is_at(spring.b)) continue;
    auto value = static_cast<float>(stiffness.next);
    const auto first = static_cast<float>(stiffness.first);
    if (!add_slider(spring.name + " (N/m)", value, 0.1f * first, static_cast<float>(stiffness.most), "%.4g",
                    ImGuiSliderFlags_Logarithmic))
      continue;
    stiffness.next = std::min<double>(value, stiffness.most);  // as a float, `most` may be larger
    run_.post(
        [i, wanted = stiffness.next](LiveSimulation& simulation) { simulation.set_stiffness(i, wanted); });
  }
}

void LiveMotion::report(std::ostream& out) const {
  const Snapshot& now = *snapshot_;
  out << std::setprecision(17) << "time " << now.state.time() << " s, speed " << now.speed
      << ", last interval computed in " << now.interval_cost << " s, late by " << now.delay << " s";
  if (now.dragging) out << ", held " << now.held.transpose() << ", target " << now.target.transpose();
  out << "\n";
}

}  // namespace pliant
