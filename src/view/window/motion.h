// The interface of the motion that a window shows: a running simulation, or a recording.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include <pliant/render/state_picture.h>
#include <pliant/view/pick.h>

namespace pliant {

class Motion {
 public:
  virtual ~Motion() = default;

  /// Fetches the newest state. Returns whether the picture has changed since the last call.
  virtual bool refresh() = 0;
  /// Makes the picture of the state again, after a setting of the picture has changed.
  virtual void show_again() = 0;
  /// The picture of the state with its meshes. The window changes its camera.
  virtual StatePicture& shown() = 0;
  virtual double time() const = 0;  ///< of the state that is shown, s

  /// Wall time by which a simulation is late, s; 0 for a recording. For a late simulation the window draws
  /// fewer pictures.
  virtual double delay() const = 0;
  virtual bool plays() const = 0;
  virtual void play(bool on) = 0;
  /// Pauses and advances by one interval, or by one frame of a recording.
  virtual void step() = 0;
  /// Pauses and returns to the start.
  virtual void reset() = 0;
  /// Colours the parts by their strain, or by their own colours.
  virtual void color_by_strain(bool on) = 0;
  /// Shows all kinds of forces, or none.
  virtual void toggle_forces() = 0;

  /// Begins to drag the point of a hit. Returns the name of its part, or std::nullopt if the point
  /// cannot be dragged.
  virtual std::optional<std::string> grab(const Hit& hit) = 0;
  virtual void drag_to(const Vec3<double>& position) = 0;
  virtual void release() = 0;
  /// Writes the scene with the actions of the user. Returns a text for the user; empty if the panel shows it
  /// later.
  virtual std::string save() = 0;

  /// Adds the controls and values of this kind of motion to the panel of the window. selected: the name of
  /// the part that was clicked last.
  virtual void add_to_panel(const std::string& selected) = 0;
  /// Prints the time and, for a simulation, the speed (simulated time / wall time) and the state of a drag,
  /// for scripts and benches.
  virtual void report(std::ostream& out) const = 0;
};

}  // namespace pliant
