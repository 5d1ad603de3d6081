#include <pliant/body/actuation/named_signal.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/multibody.h>

namespace pliant {

namespace {

using SignalKind = Signal::Kind;

/// Returns the component 0, 1 or 2 of a name that is a prefix and "x", "y" or "z"; -1 for other names.
int component(const std::string& name, const std::string& prefix) {
  if (name.size() != prefix.size() + 1 || name.compare(0, prefix.size(), prefix) != 0) return -1;
  const char last = name.back();
  return last >= 'x' && last <= 'z' ? last - 'x' : -1;
}

/// Returns the signal of a position or velocity, "x" ... "vz"; std::nullopt for another name.
std::optional<Signal> place_signal(const std::string& quantity, SignalKind place, SignalKind rate) {
  Signal signal;
  if (const int i = component(quantity, ""); i >= 0) {
    signal.kind = place;
    signal.index = i;
  } else if (const int k = component(quantity, "v"); k >= 0) {
    signal.kind = rate;
    signal.index = k;
  } else {
    return {};
  }
  return signal;
}

/// Returns the signal of the distance of two points ("length") or of its rate ("rate"); std::nullopt for
/// another name.
std::optional<Signal> length_signal(const std::string& quantity, const Point& a, const Point& b) {
  if (quantity != "length" && quantity != "rate") return {};
  Signal signal;
  signal.kind = quantity == "length" ? SignalKind::distance : SignalKind::distance_rate;
  signal.a = a;
  signal.b = b;
  return signal;
}

/// A quantity of a type of joint: a row of the coordinate of the joint, or the rate of this row.
struct JointQuantity {
  const char* joint;
  const char* quantity;
  int row;
  bool rate;
};
constexpr JointQuantity kJointQuantities[] = {
    {"hinge", "angle", 0, false},     {"hinge", "rate", 0, true},      {"slider", "position", 0, false},
    {"slider", "rate", 0, true},      {"ball", "twist", 0, false},     {"ball", "swing_y", 1, false},
    {"ball", "swing_z", 2, false},    {"ball", "twist_rate", 0, true}, {"ball", "swing_y_rate", 1, true},
    {"ball", "swing_z_rate", 2, true}};

std::string listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

std::vector<std::string> quantities_of(const Part& part) {
  std::vector<std::string> names{"x", "y", "z", "vx", "vy", "vz", "omega.x", "omega.y", "omega.z"};
  for (int k = 0; k < part.parameters().n_dynamic(); ++k) {
    names.push_back(part.parameters().moving(k).name);
    names.push_back(part.parameters().moving(k).name + "_dot");
  }
  return names;
}
std::vector<std::string> quantities_of(const Joint& joint) {
  std::vector<std::string> names;
  for (const JointQuantity& known : kJointQuantities)
    if (known.joint == std::string(joint.type())) names.emplace_back(known.quantity);
  if (joint.rows() == 1 && joint.points().size() == 2) names = {"length", "rate"};
  return names;
}

/// Returns the signal of a quantity of a part; std::nullopt for an unknown quantity.
std::optional<Signal> signal_of(const Part& part, const std::string& quantity) {
  std::optional<Signal> signal = place_signal(quantity, SignalKind::position, SignalKind::velocity);
  if (const int i = component(quantity, "omega."); i >= 0) {
    signal.emplace();
    signal->kind = SignalKind::angular_velocity;
    signal->index = i;
  }
  for (const bool rate : {false, true}) {
    if (signal || (rate && (quantity.size() < 5 || quantity.compare(quantity.size() - 4, 4, "_dot") != 0)))
      continue;
    const int k = part.parameters().dynamic_number(rate ? quantity.substr(0, quantity.size() - 4) : quantity);
    if (k < 0) continue;
    signal.emplace();
    signal->kind = rate ? SignalKind::parameter_rate : SignalKind::parameter;
    signal->index = k;
  }
  if (signal) signal->part = &part;
  return signal;
}

/// Returns the signal of a quantity of a joint; std::nullopt for an unknown quantity.
std::optional<Signal> signal_of(MultiBody& body, const Joint& joint, const std::string& quantity) {
  if (joint.rows() == 1 && joint.points().size() == 2)
    return length_signal(quantity, joint.points()[0], joint.points()[1]);
  for (const JointQuantity& known : kJointQuantities) {
    if (known.joint != std::string(joint.type()) || known.quantity != quantity) continue;
    Signal signal;
    signal.kind = known.rate ? SignalKind::coordinate_rate : SignalKind::coordinate;
    signal.coordinate = &body.coordinate(joint);
    signal.index = known.row;
    return signal;
  }
  return {};
}

}  // namespace

std::optional<Signal> named_signal(MultiBody& body, const std::string& owner, const std::string& quantity,
                                   const NamedPoints& points) {
  std::vector<Signal> found;
  std::vector<std::string> known, kinds;
  auto consider = [&](const char* kind, std::optional<Signal> signal, const std::vector<std::string>& names) {
    known.insert(known.end(), names.begin(), names.end());
    if (!signal) return;
    found.push_back(*signal);
    kinds.emplace_back(kind);
  };
  static const std::vector<std::string> places{"x", "y", "z", "vx", "vy", "vz"}, lengths{"length", "rate"};
  if (const Part* part = body.find(owner)) consider("part", signal_of(*part, quantity), quantities_of(*part));
  for (const auto& joint : body.joints())
    if (joint->name() == owner) consider("joint", signal_of(body, *joint, quantity), quantities_of(*joint));
  for (const auto& spring : body.springs())
    if (spring->name == owner) consider("spring", length_signal(quantity, spring->a, spring->b), lengths);
  if (const auto point = points.find(owner); point != points.end()) {
    std::optional<Signal> signal = place_signal(quantity, SignalKind::point, SignalKind::point_rate);
    if (signal) signal->a = point->second;
    consider("track", signal, places);
  }
  for (const auto& sensor : body.sensors()) {
    if (sensor->name != owner || !quantity.empty()) continue;
    Signal signal;
    signal.kind = SignalKind::sensor;
    signal.sensor = sensor.get();
    consider("sensor", signal, {});
  }
  for (std::size_t k = 0; k < body.inputs().size(); ++k) {
    if (body.inputs()[k].name != owner || !quantity.empty()) continue;
    Signal signal;
    signal.kind = SignalKind::input;
    signal.index = static_cast<int>(k);
    consider("input", signal, {});
  }
  if (found.size() > 1)
    throw std::invalid_argument("\"" + owner + "\" is the name of a " + kinds[0] + " and of a " + kinds[1] +
                                ", and both have this quantity; expected different names");
  if (found.size() == 1) return found.front();
  if (known.empty()) return {};
  throw std::invalid_argument("\"" + owner + "\" has no quantity \"" + quantity + "\"; expected one of " +
                              listed(known));
}

StateFunction state_formula(MultiBody& body, const std::string& text, const NamedPoints& points,
                            const std::vector<std::string>& at_points) {
  std::vector<Signal> signals;
  std::map<std::pair<std::string, std::string>, int> numbers;  // of the names read so far
  Formula formula(text, [&](const std::string& owner, const std::string& quantity) {
    const auto [known, is_new] = numbers.try_emplace({owner, quantity}, static_cast<int>(signals.size()));
    if (!is_new) return known->second;
    std::optional<Signal> signal;
    const auto at_point = std::find(at_points.begin(), at_points.end(), owner);
    if (quantity.empty() && at_point != at_points.end()) {
      const auto has_name = [&](const auto& named) { return named->name == owner; };
      if (std::any_of(body.sensors().begin(), body.sensors().end(), has_name) ||
          std::any_of(body.inputs().begin(), body.inputs().end(),
                      [&](const Input& input) { return input.name == owner; }))
        throw std::invalid_argument("\"" + owner +
                                    "\" is the name of a quantity at the point, and of a sensor or input; "
                                    "expected another name of the sensor or input");
      signal.emplace();
      signal->kind = SignalKind::at_point;
      signal->index = static_cast<int>(at_point - at_points.begin());
    } else {
      signal = named_signal(body, owner, quantity, points);
    }
    if (!signal && quantity.empty()) return -1;
    if (!signal)
      throw std::invalid_argument("there is no part, joint, spring, track, sensor or input \"" + owner +
                                  "\"");
    signals.push_back(*signal);
    return known->second;
  });
  if (!formula.has_variables()) return TimeFunction::formula(text);
  return {std::move(formula), std::move(signals)};
}

}  // namespace pliant
