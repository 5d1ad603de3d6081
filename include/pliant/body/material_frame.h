// Directions that are fixed in the material of a part: a frame at a material point x_0, defined by three
// points x_1, x_2, x_3 around x_0. The axes are linear combinations of the differences x_i - x_0,
// orthonormalised in their order. They therefore follow the rotation and the deformation of the part. The
// axes of a frame of the world are constant.
#pragma once

#include <vector>

#include <pliant/body/points.h>
#include <pliant/math/scalar/functions.h>

namespace pliant {

/// A point with axes (the columns of a rotation), world.
template <class T>
struct Framed {
  Vec3<T> x;
  Mat3<T> axes;
};

struct MaterialFrame {
  static constexpr int points = 4;
  /// Coefficients, 1/m: axes = (x_1 - x_0, x_2 - x_0, x_3 - x_0) K before orthonormalisation.
  Mat3<double> K = Mat3<double>::Identity();
  Mat3<double> world_axes = Mat3<double>::Zero();  ///< axes of a frame of the world; zero on a part

  /// Returns the axes in the world, as columns. x: positions of x_0 ... x_3, m, world.
  template <class T>
  Mat3<T> at(const Vec3<T>* x) const {
    if (!world_axes.isZero(0)) return world_axes.cast<T>();
    const Vec3<T> e_1 = edge(x, 0), e_2 = edge(x, 1);
    Mat3<T> axes;
    axes.col(0) = e_1 / length(e_1);
    const Vec3<T> across = e_2 - axes.col(0) * axes.col(0).dot(e_2);
    axes.col(1) = across / length(across);
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
  }
  template <class T>
  Framed<T> framed_at(const Vec3<T>* x) const {
    return {x[0], at(x)};
  }

  /// Returns the 3 x 12 matrix `turn` with dA = A [dphi]x, dphi = turn dx: the rotation of the axes A when
  /// the points move by dx.
  template <class T>
  Eigen::Matrix<T, 3, 3 * points> turn(const Vec3<T>* x, const Mat3<T>& A) const {
    Eigen::Matrix<T, 3, 3 * points> turn = Eigen::Matrix<T, 3, 3 * points>::Constant(T(0.0));
    if (!world_axes.isZero(0)) return turn;
    const Vec3<T> e_1 = edge(x, 0), e_2 = edge(x, 1);
    const T along = A.col(0).dot(e_2), inverse_1 = T(1.0) / length(e_1),
            inverse_2 = T(1.0) / A.col(1).dot(e_2);
    for (int k = 0; k < 3; ++k) {
      Mat3<T> d;  // derivative of dphi with respect to x_(k + 1)
      d.row(2) = A.col(1).transpose() * T(inverse_1 * K(k, 0));
      d.row(1) = A.col(2).transpose() * T(-inverse_1 * K(k, 0));
      d.row(0) = (A.col(2).transpose() * T(K(k, 1)) + d.row(1) * along) * inverse_2;
      turn.template middleCols<3>(3 * k + 3) = d;
      turn.template leftCols<3>() -= d;
    }
    return turn;
  }

 private:
  /// Returns axis c before orthonormalisation.
  template <class T>
  Vec3<T> edge(const Vec3<T>* x, int c) const {
    return (x[1] - x[0]) * T(K(0, c)) + (x[2] - x[0]) * T(K(1, c)) + (x[3] - x[0]) * T(K(2, c));
  }
  template <class T>
  static T length(const Vec3<T>& x) {
    return math::sqrt(T(x.dot(x)));
  }
};

struct FramedPoint {
  std::vector<Point> points;  ///< x_0 ... x_3
  MaterialFrame frame;
};

/// Returns a frame at a point. axes: the axes of the frame for the undeformed part, as the columns of a
/// rotation, in the frame of the part; in the world for a point of the world. The part must be prepared.
/// Throws std::invalid_argument if no three directions around the point are linearly independent.
FramedPoint framed(const Point& at, const Mat3<double>& axes);

/// Returns a rotation whose first column is along a direction (of any length > 0).
Mat3<double> axes_along(const Vec3<double>& direction);

}  // namespace pliant
