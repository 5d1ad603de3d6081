#include <pliant/body/actuation/joint_coordinate.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>

#include <pliant/body/actuation/ball_rotation.h>
#include <pliant/body/actuation/coordinate_limit.h>
#include <pliant/body/actuation/hinge_angle.h>
#include <pliant/body/actuation/slider_position.h>
#include <pliant/body/joints/ball.h>
#include <pliant/body/joints/hinge.h>
#include <pliant/body/joints/slider.h>

namespace pliant {

namespace {

/// Returns the coordinate of formula C of a joint of formula F, at the points of the joint; nullptr if the
/// joint is of another type.
template <class F, class C>
std::unique_ptr<Joint> coordinate_at_points(const Joint& joint) {
  const auto* of_type = dynamic_cast<const JointOf<F>*>(&joint);
  if (of_type == nullptr) return nullptr;
  C formula{};
  formula.from = of_type->formula().from;
  formula.to = of_type->formula().to;
  return std::make_unique<JointOf<C>>(joint.name(), joint.points(), formula);
}

/// Returns the coordinate of a ball joint, whose frames at the two points coincide when the rotation is zero.
std::unique_ptr<Joint> ball_rotation(const Joint& joint, const BallAxes& ball) {
  const Point &a = joint.points()[0], &b = joint.points()[1];
  auto orientation = [](const Point& point) {
    return point.part == nullptr ? Eigen::Quaterniond::Identity() : point.part->R0();
  };
  const Eigen::Quaterniond turn =
      ball.rotation ? ball.rotation->normalized() : orientation(b).conjugate() * orientation(a);
  const Mat3<double> axes = axes_along(ball.axis);
  const FramedPoint from = framed(a, turn.toRotationMatrix().transpose() * axes), to = framed(b, axes);
  std::vector<Point> points = from.points;
  points.insert(points.end(), to.points.begin(), to.points.end());
  BallRotation formula{};
  formula.from = from.frame;
  formula.to = to.frame;
  return std::make_unique<JointOf<BallRotation>>(joint.name(), points, formula);
}

/// Returns the size of the smallest part with coordinates at a joint, m.
double smallest_size(const Joint& joint) {
  double size = std::numeric_limits<double>::infinity();
  for (const Point& point : joint.points())
    if (point.part != nullptr && !point.part->fixed()) size = std::min(size, point.part->size());
  return size;
}

/// The end of the range that a limit bounds: the suffix of the name of the limit, and LimitRange::sign.
struct End {
  const char* name;
  double sign;
};
constexpr End kLower{".lower", -1}, kUpper{".upper", 1}, kSwing{".swing", 1};

/// Returns the limits of formula L of a coordinate of formula C at some ends of a range; none if the
/// coordinate is of another type.
template <class C, class L>
std::vector<std::unique_ptr<Joint>> limits_of(const Joint& coordinate, const LimitRange& range,
                                              std::initializer_list<End> ends) {
  std::vector<std::unique_ptr<Joint>> limits;
  const auto* of_type = dynamic_cast<const JointOf<C>*>(&coordinate);
  if (of_type == nullptr) return limits;
  for (const End& end : ends) {
    L formula{};
    static_cast<LimitRange&>(formula) = range;
    formula.sign = end.sign;
    formula.from = of_type->formula().from;
    formula.to = of_type->formula().to;
    limits.push_back(
        std::make_unique<JointOf<L>>(coordinate.name() + end.name, coordinate.points(), formula));
  }
  return limits;
}

/// Returns the range [lower, upper]. Throws std::invalid_argument for invalid numbers. longest: an upper
/// bound of the length of the range.
LimitRange range_of(const Joint& coordinate, double lower, double upper, double longest, double restitution) {
  const std::string what = "limits of joint '" + coordinate.name() + "': ";
  if (!(lower < upper) || !(upper - lower < longest))
    throw std::invalid_argument(what + "expected a range with lower < upper" +
                                (std::isfinite(longest) ? ", less than one turn minus 0.1 rad" : ""));
  if (!(restitution >= 0 && restitution <= 1))
    throw std::invalid_argument(what + "expected a restitution from 0 to 1");
  return {(lower + upper) / 2, (upper - lower) / 2, 1, smallest_size(coordinate), restitution};
}

constexpr double kAnyLength = std::numeric_limits<double>::infinity();
/// Longest range of an angle, rad. In one step, a joint must not turn across the 0.1 rad outside the range.
constexpr double kLongestTurn = 2 * kPi - 0.1;

}  // namespace

std::vector<std::unique_ptr<Joint>> make_limits(const Joint& coordinate, double lower, double upper,
                                                double restitution) {
  if (coordinate.type() == std::string(HingeAngle::name))
    return limits_of<HingeAngle, HingeLimit>(
        coordinate, range_of(coordinate, lower, upper, kLongestTurn, restitution), {kLower, kUpper});
  if (coordinate.type() == std::string(SliderPosition::name))
    return limits_of<SliderPosition, SliderLimit>(
        coordinate, range_of(coordinate, lower, upper, kAnyLength, restitution), {kLower, kUpper});
  throw std::invalid_argument("joint '" + coordinate.name() +
                              "' has a swing and a twist; expected limits of these");
}

std::vector<std::unique_ptr<Joint>> make_swing_limit(const Joint& coordinate, double max,
                                                     double restitution) {
  auto limits = limits_of<BallRotation, SwingLimit>(
      coordinate, range_of(coordinate, -max, max, kLongestTurn, restitution), {kSwing});
  if (limits.empty()) throw std::invalid_argument("joint '" + coordinate.name() + "' has no swing");
  return limits;
}

std::vector<std::unique_ptr<Joint>> make_twist_limits(const Joint& coordinate, double lower, double upper,
                                                      double restitution) {
  auto limits = limits_of<BallRotation, TwistLimit>(
      coordinate, range_of(coordinate, lower, upper, kLongestTurn, restitution), {kLower, kUpper});
  if (limits.empty()) throw std::invalid_argument("joint '" + coordinate.name() + "' has no twist");
  return limits;
}

std::unique_ptr<Joint> make_coordinate(const Joint& joint, const BallAxes& ball) {
  std::unique_ptr<Joint> coordinate = coordinate_at_points<Hinge, HingeAngle>(joint);
  if (!coordinate) coordinate = coordinate_at_points<Slider, SliderPosition>(joint);
  if (!coordinate && dynamic_cast<const JointOf<Ball>*>(&joint) != nullptr)
    coordinate = ball_rotation(joint, ball);
  if (coordinate) {
    coordinate->during(joint.on(), joint.off());
    return coordinate;
  }
  throw std::invalid_argument(std::string(joint.type()) + " '" + joint.name() +
                              "' has no coordinate; a hinge, a slider and a ball joint have one");
}

int coordinate_rows(const std::string& type) {
  if (type == Ball::name) return BallRotation::rows;
  return type == Hinge::name || type == Slider::name ? 1 : 0;
}

bool is_angle(const std::string& type) {
  return type == Hinge::name || type == Ball::name;
}

}  // namespace pliant
