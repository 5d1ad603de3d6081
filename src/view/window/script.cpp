#include "script.h"

#include <fstream>
#include <ostream>
#include <sstream>
#include <stdexcept>

#include <pliant/io/format/png.h>

namespace pliant {
namespace {

MouseButton button_of(const std::string& name) {
  return name == "right" ? MouseButton::right : name == "middle" ? MouseButton::middle : MouseButton::left;
}

}  // namespace

Script::Script(const std::filesystem::path& file) : file_(file) {
  std::ifstream stream(file);
  if (!stream) throw std::invalid_argument("cannot read the script " + file.string());
  for (std::string line; std::getline(stream, line);) lines_.push_back(line);
}

void Script::fail(const std::string& reason) const {
  throw std::invalid_argument(file_.string() + ":" + std::to_string(next_) + ": " + reason);
}

/// Moves the mouse over the middle of the mesh of a part.
void Script::move_over(const std::string& part, Viewer& viewer) const {
  StatePicture& shown = viewer.motion().shown();
  for (const NamedMesh& body : shown.bodies()) {
    if (body.name != part) continue;
    const Vec3<double> place = place_in_window(shown.picture().camera, body.mesh.x.rowwise().mean(),
                                               viewer.width(), viewer.height());
    viewer.mouse_moved(place[0], place[1]);
    return;
  }
  fail("no visible part '" + part + "'");
}

bool Script::perform(Viewer& viewer, std::ostream& out) {
  if (pictures_ > 0) {
    --pictures_;
    return true;
  }
  if (viewer.motion().time() < until_) return true;
  until_ = -1;
  while (next_ < lines_.size()) {
    const std::string& line = lines_[next_++];
    if (perform_line(line, viewer, out)) return true;
  }
  return false;
}

/// Performs one line. Returns whether the line waits for pictures.
bool Script::perform_line(const std::string& line, Viewer& viewer, std::ostream& out) {
  std::istringstream words(line);
  std::string word, name;
  double x = 0, y = 0;
  if (!(words >> word) || word[0] == '#') return false;
  if (word == "pictures" && words >> pictures_) return true;
  if (word == "until" && words >> until_) return true;
  if (word == "move" && words >> x >> y) return viewer.mouse_moved(x, y), false;
  if (word == "wheel" && words >> x) return viewer.wheel_turned(x), false;
  if (word == "report") return viewer.motion().report(out), false;
  if (word == "part") return out << "part " << viewer.selected() << "\n", false;
  if (!(words >> name)) fail("the line '" + line + "' is not known or not complete");
  if (word == "over") return move_over(name, viewer), false;
  if (word == "press") return viewer.mouse_pressed(button_of(name), !(words >> word).fail()), false;
  if (word == "release") return viewer.mouse_released(button_of(name)), false;
  if (word == "key") return viewer.key_pressed(name), false;
  if (word == "photograph")
    return write_png(viewer.renderer().read(viewer.width(), viewer.height()), name), false;
  fail("the line '" + line + "' is not known");
}

}  // namespace pliant
