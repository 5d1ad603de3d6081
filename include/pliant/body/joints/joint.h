// A joint: a constraint C(x, t) = 0, Eq. (12), on the world points x that it connects. The formula of a joint
// is one struct (body/joints/*.h) with a template for the scalar type. All other quantities are derived from
// the formula:
//   C_dot = C_x x_dot + C_t,   C_q = C_x L,   C_ddot = C_q v_dot + bias,   bias = -gamma of Eq. (13)
// Here L is the matrix of Eq. (9), x_dot = L v. bias is C_ddot for constant generalised velocities v: the
// second derivative of C along a motion of the points with velocity x_dot and acceleration L_dot v. Points
// with a prescribed motion follow this motion. bias contains the terms with C_tt and C_qt of Eq. (13).
#pragma once

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/body/material_frame.h>
#include <pliant/body/points.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/taylor2.h>

namespace pliant {

/// Largest numbers of rows and of points of a joint.
inline constexpr int kMaxJointRows = 6;
inline constexpr int kMaxJointPoints = 8;

/// The motion of a point in the world: position (m), velocity (m/s), and acceleration (m/s^2) for constant
/// generalised velocities.
template <class S>
struct PointMotion {
  Vec3<S> x, x_dot, x_ddot;
};

/// The rows of a joint for a motion of its points.
template <class S>
struct JointRows {
  VecMax<S, kMaxJointRows> C;      ///< m
  VecMax<S, kMaxJointRows> C_dot;  ///< m/s
  VecMax<S, kMaxJointRows> bias;   ///< m/s^2
  /// dC/dx, rows x (3 times the number of points).
  Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJointRows, 3 * kMaxJointPoints> C_x;
};

/// The interface of all joints.
class Joint {
 public:
  Joint(std::string name, std::vector<Point> points, int n_first, int n_points)
      : name_(std::move(name)), points_(std::move(points)), n_first_(n_first), n_points_(n_points) {}
  virtual ~Joint() = default;

  const std::string& name() const { return name_; }
  /// Sets the times at which the joint acts: from `on` (s) until before `off`; the default is always. Throws
  /// std::invalid_argument unless on < off.
  Joint& during(double on, double off = std::numeric_limits<double>::infinity()) {
    if (!(on < off)) throw std::invalid_argument("joint '" + name_ + "' needs times on < off");
    on_ = on;
    off_ = off;
    return *this;
  }
  double on() const { return on_; }
  double off() const { return off_; }
  bool acts_at(double t) const { return t >= on_ && t < off_; }
  virtual const char* type() const = 0;
  virtual int rows() const = 0;
  /// Returns whether the constraint is C >= 0 with a multiplier lambda >= 0, instead of C = 0.
  virtual bool one_sided() const = 0;
  /// Returns the share, from 0 to 1, of the rate -C_dot that is reversed when a one-sided joint stops a
  /// motion.
  virtual double restitution() const { return 0; }

  /// The points of the first side, then the points of the second side. All points of a side are on one part,
  /// or all are points of the world.
  const std::vector<Point>& points() const { return points_; }
  /// Number of points of the first side.
  int n_first() const { return n_first_; }
  int n_points() const { return n_points_; }

  /// Computes the rows of the joint at time t (s). x: the motion of each point. out is resized.
  virtual void evaluate(double t, const PointMotion<double>* x, JointRows<double>& out) const = 0;
  virtual void evaluate(double t, const PointMotion<Dual<1>>* x, JointRows<Dual<1>>& out) const = 0;
  /// Returns C (m) at time t (s) for positions x (m, world) of the points.
  virtual VecMax<double, kMaxJointRows> gap(double t, const Vec3<double>* x) const = 0;

 private:
  std::string name_;
  std::vector<Point> points_;
  int n_first_, n_points_;
  double on_ = -std::numeric_limits<double>::infinity(), off_ = std::numeric_limits<double>::infinity();
};

/// A formula that is linear in x, without a constant and without t, declares
///   static constexpr bool linear = true;
template <class F, class = void>
struct IsLinear : std::false_type {};
template <class F>
struct IsLinear<F, std::void_t<decltype(F::linear)>> : std::bool_constant<F::linear> {};

/// A formula on points with axes (Framed) declares
///   static constexpr bool framed = true;
/// Its second side has axes, a member MaterialFrame `to` and four points. Its first side has either axes, a
/// member MaterialFrame `from` and four points, or one point without axes. The formula is
/// @code
///   template <class T>
///   Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const;
/// @endcode
template <class F, class = void>
struct IsFramed : std::false_type {};
template <class F>
struct IsFramed<F, std::void_t<decltype(F::framed)>> : std::bool_constant<F::framed> {};

/// Whether a formula has a function fault(). fault() returns a message if a number of the formula is invalid,
/// else nullptr.
template <class F, class = void>
struct HasFault : std::false_type {};
template <class F>
struct HasFault<F, std::void_t<decltype(std::declval<const F&>().fault())>> : std::true_type {};

/// Whether a formula of a one-sided joint has a member `restitution`.
template <class F, class = void>
struct HasRestitution : std::false_type {};
template <class F>
struct HasRestitution<F, std::void_t<decltype(std::declval<const F&>().restitution)>> : std::true_type {};

/// The joint of a formula F. F declares as static constants: `name`; `formula`, a text; `rows`, the number of
/// rows; `first` and `second`, the numbers of points of its sides (second = 0 for a joint to the world
/// whose formula needs no second point); and `one_sided`. The function of the formula is
/// @code
///   template <class T>
///   Vec<T, rows> C(const std::array<Vec3<T>, first + second>& x, const T& t) const;
/// @endcode
/// Formulas for scenes also declare `keys`, the members of JointSetting that they use.
template <class F>
class JointOf final : public Joint {
 public:
  static constexpr int kRows = F::rows, kPoints = F::first + F::second;
  static_assert(kRows >= 1 && kRows <= kMaxJointRows, "a joint has one to six rows");
  static_assert(F::first >= 1 && kPoints <= kMaxJointPoints,
                "a joint ties one to eight points, at least one on its first side");

  JointOf(std::string name, std::vector<Point> points, F formula = {})
      : Joint(std::move(name), std::move(points), F::first, kPoints), formula_(std::move(formula)) {
    if constexpr (HasFault<F>::value)
      if (const char* fault = formula_.fault())
        throw std::invalid_argument(std::string(F::name) + " '" + this->name() + "' " + fault);
    if constexpr (IsLinear<F>::value) slope_ = constant_slope();
  }

  template <class T>
  using Points = std::array<Vec3<T>, kPoints>;

  /// Returns C at the points.
  template <class T>
  Vec<T, kRows> C(const Points<T>& x, const T& t) const {
    if constexpr (IsFramed<F>::value)
      return formula_.template C<T>(first_side(x.data()), second_side(x.data()));
    else
      return formula_.template C<T>(x, t);
  }

  const char* type() const override { return F::name; }
  int rows() const override { return kRows; }
  bool one_sided() const override { return F::one_sided; }
  double restitution() const override {
    if constexpr (HasRestitution<F>::value) return formula_.restitution;
    return 0;
  }
  const F& formula() const { return formula_; }

  void evaluate(double t, const PointMotion<double>* x, JointRows<double>& out) const override {
    evaluate_as<double>(t, x, out);
  }
  void evaluate(double t, const PointMotion<Dual<1>>* x, JointRows<Dual<1>>& out) const override {
    evaluate_as<Dual<1>>(t, x, out);
  }
  VecMax<double, kMaxJointRows> gap(double t, const Vec3<double>* x) const override {
    std::array<Vec3<double>, kPoints> at;
    for (int k = 0; k < kPoints; ++k) at[static_cast<std::size_t>(k)] = x[k];
    return C<double>(at, t);
  }

 private:
  template <class T>
  Framed<T> first_side(const Vec3<T>* x) const {
    if constexpr (F::first == 1)
      return {x[0], Mat3<T>::Constant(T(0.0))};
    else
      return formula_.from.framed_at(x);
  }
  template <class T>
  Framed<T> second_side(const Vec3<T>* x) const {
    return formula_.to.framed_at(x + F::first);
  }

  template <class S>
  void evaluate_as(double t, const PointMotion<S>* x, JointRows<S>& out) const {
    if constexpr (IsLinear<F>::value) {
      Points<S> at, rate, bias;
      for (std::size_t k = 0; k < at.size(); ++k) {
        at[k] = x[k].x;
        rate[k] = x[k].x_dot;
        bias[k] = x[k].x_ddot;
      }
      out.C = formula_.template C<S>(at, S(t));
      out.C_dot = formula_.template C<S>(rate, S(t));
      out.bias = formula_.template C<S>(bias, S(t));
      out.C_x = slope_.template cast<S>();
    } else {
      using T = Taylor2<S>;
      Points<T> moving;
      Points<S> at;
      for (int k = 0; k < kPoints; ++k) {
        const auto p = static_cast<std::size_t>(k);
        at[p] = x[k].x;
        for (int r = 0; r < 3; ++r) moving[p][r] = T(x[k].x[r], x[k].x_dot[r], x[k].x_ddot[r]);
      }
      const Vec<T, kRows> rates = C<T>(moving, T(S(t), S(1.0), S(0.0)));
      out.C.resize(kRows);
      out.C_dot.resize(kRows);
      out.bias.resize(kRows);
      for (int r = 0; r < kRows; ++r) {
        out.C[r] = rates[r].v;
        out.C_dot[r] = rates[r].d;
        out.bias[r] = rates[r].dd;
      }
      out.C_x = slope(S(t), at);
    }
  }

  /// Returns dC/dx.
  template <class S>
  Eigen::Matrix<S, kRows, 3 * kPoints> slope(const S& t, const Points<S>& x) const {
    if constexpr (IsFramed<F>::value) {
      return framed_slope(x);
    } else {
      using D = Dual<3 * kPoints, S>;
      Points<D> varied;
      for (int k = 0; k < kPoints; ++k)
        for (int r = 0; r < 3; ++r)
          varied[static_cast<std::size_t>(k)][r] = D::variable(x[static_cast<std::size_t>(k)][r], 3 * k + r);
      const Vec<D, kRows> rows = C<D>(varied, D(t));
      Eigen::Matrix<S, kRows, 3 * kPoints> C_x;
      for (int r = 0; r < kRows; ++r)
        for (int c = 0; c < 3 * kPoints; ++c) C_x(r, c) = rows[r].d[static_cast<std::size_t>(c)];
      return C_x;
    }
  }
  /// Returns dC/dx by the chain rule: the derivatives of C with respect to the points x_0 and the rotations
  /// of the axes, times the derivatives of the rotations with respect to the points of the frames
  /// (MaterialFrame::turn).
  template <class S>
  Eigen::Matrix<S, kRows, 3 * kPoints> framed_slope(const Points<S>& x) const {
    using D = Dual<12, S>;
    const Framed<S> a = first_side(x.data()), b = second_side(x.data());
    const Vec<D, kRows> rows = formula_.template C<D>(varied<D>(a, 0), varied<D>(b, 6));
    Eigen::Matrix<S, kRows, 3 * kPoints> C_x = Eigen::Matrix<S, kRows, 3 * kPoints>::Constant(S(0.0));
    Eigen::Matrix<S, kRows, 12> C_u;
    for (int r = 0; r < kRows; ++r)
      for (std::size_t c = 0; c < 12; ++c) C_u(r, static_cast<Eigen::Index>(c)) = rows[r].d[c];
    if constexpr (F::first > 1)
      C_x.template leftCols<3 * F::first>() =
          C_u.template middleCols<3>(3).lazyProduct(formula_.from.turn(x.data(), a.axes));
    C_x.template rightCols<3 * F::second>() =
        C_u.template middleCols<3>(9).lazyProduct(formula_.to.turn(x.data() + F::first, b.axes));
    C_x.template leftCols<3>() += C_u.template leftCols<3>();
    C_x.template middleCols<3>(3 * F::first) += C_u.template middleCols<3>(6);
    return C_x;
  }
  /// Returns x + dx and the axes A + A [phi]x, where dx and phi are the dual variables from `first` on.
  template <class D, class S>
  static Framed<D> varied(const Framed<S>& frame, std::size_t first) {
    Framed<D> out;
    for (int i = 0; i < 3; ++i) {
      out.x[i] = D::variable(frame.x[i], static_cast<int>(first) + i);
      for (int c = 0; c < 3; ++c) {
        const int next = (c + 1) % 3, last = (c + 2) % 3;
        out.axes(i, c) = D(frame.axes(i, c));
        out.axes(i, c).d[first + 3 + static_cast<std::size_t>(last)] = frame.axes(i, next);
        out.axes(i, c).d[first + 3 + static_cast<std::size_t>(next)] = -frame.axes(i, last);
      }
    }
    return out;
  }
  Eigen::Matrix<double, kRows, 3 * kPoints> constant_slope() const {
    Points<double> x;
    for (Vec3<double>& point : x) point.setZero();
    return slope(0.0, x);
  }

  F formula_;
  Eigen::Matrix<double, IsLinear<F>::value ? kRows : 0, 3 * kPoints> slope_;  ///< dC/dx of a linear formula
};

}  // namespace pliant
