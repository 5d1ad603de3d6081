// The panel of the window: buttons, settings, values, the list of parts and the scale of values.
#include <imgui.h>

#include <pliant/render/color_map.h>
#include <pliant/render/ticks.h>

#include "viewer.h"

namespace pliant {
namespace {

ImU32 color_of(const Eigen::Vector3f& color) {
  return ImGui::ColorConvertFloat4ToU32({color[0], color[1], color[2], 1});
}

}  // namespace

void Viewer::add_panel() {
  constexpr float kWidth = 255, kMargin = 10;
  ImGui::SetNextWindowPos({kMargin, kMargin}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({kWidth, 0});
  ImGui::SetNextWindowSizeConstraints({kWidth, 0}, {kWidth, static_cast<float>(height_) - 2 * kMargin});
  ImGui::SetNextWindowBgAlpha(0.8f);
  ImGui::Begin("pliant", nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize);
  if (ImGui::Button(motion_.plays() ? "pause" : "play ")) motion_.play(!motion_.plays());
  ImGui::SameLine();
  if (ImGui::Button("step")) motion_.step();
  ImGui::SameLine();
  if (ImGui::Button("reset")) motion_.reset();
  ImGui::SameLine();
  if (ImGui::Button("save")) message_ = motion_.save();
  motion_.add_to_panel(selected_);
  ImGui::Separator();
  bool by_strain = by_strain_;
  if (ImGui::Checkbox("strain colours", &by_strain)) color_by_strain(by_strain);
  StatePicture& shown = motion_.shown();
  ImGui::SameLine();
  bool changed = ImGui::Checkbox("meshes", &shown.picture().edges);
  changed = ImGui::Checkbox("joints and springs", &shown.shows_connectors) || changed;
  if (changed) show_again();
  add_part_list();
  if (!message_.empty()) ImGui::TextWrapped("%s", message_.c_str());
  ImGui::End();
  add_color_bar();
}

void Viewer::add_part_list() {
  if (!selected_.empty()) ImGui::Text("part: %s", selected_.c_str());
  if (!ImGui::CollapsingHeader("parts")) return;
  ImGui::BeginChild("list", {0, 150});
  for (const NamedMesh& body : motion_.shown().bodies())
    if (ImGui::Selectable(body.name.c_str(), body.name == selected_)) selected_ = body.name;
  ImGui::EndChild();
}

void Viewer::add_color_bar() {
  const std::optional<Picture::Scale>& scale = motion_.shown().picture().scale;
  if (!scale) return;
  constexpr float kBarWidth = 16, kRight = 80, kTop = 0.2f, kBottom = 0.8f;
  const auto high = static_cast<float>(height_), x = static_cast<float>(width_) - kRight;
  const float top = kTop * high, length = (kBottom - kTop) * high;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const ImU32 ink = color_of({0.1f, 0.1f, 0.12f});
  for (int i = 0; i + 1 < kMapColors; ++i) {
    const float low = static_cast<float>(i) / (kMapColors - 1),
                next = static_cast<float>(i + 1) / (kMapColors - 1);
    const ImU32 below = color_of(mapped_color(low)), above = color_of(mapped_color(next));
    list.AddRectFilledMultiColor({x, top + (1 - next) * length}, {x + kBarWidth, top + (1 - low) * length},
                                 above, above, below, below);
  }
  for (const Tick& tick : ticks(scale->low, scale->high)) {
    const auto share = static_cast<float>((tick.value - scale->low) / (scale->high - scale->low));
    const float y = top + (1 - share) * length;
    list.AddLine({x + kBarWidth, y}, {x + kBarWidth + 4, y}, ink);
    list.AddText({x + kBarWidth + 7, y - 7}, ink, tick.label.c_str());
  }
  list.AddText({x - 10, top - 24}, ink, scale->title.c_str());
}

}  // namespace pliant
