#include "force_lines.h"

#include <algorithm>
#include <utility>

#include <imgui.h>

namespace pliant {
namespace {

const Eigen::Vector3f kContactColor(0.1f, 0.55f, 0.2f), kJointColor(0.15f, 0.3f, 0.8f),
    kLoadColor(0.75f, 0.45f, 0.05f);
constexpr float kForceWidth = 2, kForceDotWidth = 5;  // pixels
constexpr double kLongestForce = 0.25;  // length of the line of the largest force, in sizes of the scene

}  // namespace

void ForceLines::toggle() {
  const bool on = !shown_.any();
  shown_ = {on, on, on};
  largest_ = 0;
}

bool ForceLines::add_to_panel() {
  ImGui::TextUnformatted("forces of");
  bool changed = ImGui::Checkbox("contacts", &shown_.contacts);
  ImGui::SameLine();
  changed = ImGui::Checkbox("joints", &shown_.joints) || changed;
  ImGui::SameLine();
  changed = ImGui::Checkbox("loads", &shown_.loads) || changed;
  if (changed) largest_ = 0;
  return changed;
}

void ForceLines::add(const ForceArrows& arrows, double size, Picture& picture) {
  struct Kind {
    bool shown;
    const std::vector<ForceArrow>& arrows;
    const Eigen::Vector3f& color;
  };
  const Kind kinds[] = {{shown_.contacts, arrows.contacts, kContactColor},
                        {shown_.joints, arrows.joints, kJointColor},
                        {shown_.loads, arrows.loads, kLoadColor}};
  for (const Kind& kind : kinds)
    for (const ForceArrow& arrow : kind.arrows)
      if (kind.shown) largest_ = std::max(largest_, arrow.force.norm());
  if (!(largest_ > 0)) return;
  for (const Kind& kind : kinds)
    if (kind.shown) add(kind.arrows, kind.color, kLongestForce * size / largest_, picture);
}

void ForceLines::add(const std::vector<ForceArrow>& arrows, const Eigen::Vector3f& color, double scale,
                     Picture& picture) {
  for (const ForceArrow& arrow : arrows) {
    add_line({arrow.at, arrow.at + scale * arrow.force}, color, kForceWidth, picture);
    add_line({arrow.at}, color, kForceDotWidth, picture);
  }
}

void add_line(std::vector<Eigen::Vector3d> points, const Eigen::Vector3f& color, float width,
              Picture& picture) {
  Picture::Track track;
  track.points = std::move(points);
  track.color = color;
  track.width = width;
  track.on_top = true;
  picture.tracks.push_back(std::move(track));
}

}  // namespace pliant
