// Directions fixed in the material of a part: a frame at a material point x_0, carried by three points x_1,
// x_2, x_3 around it. The axes are combinations of the differences x_i - x_0, made orthonormal, the first
// axis first, so that they follow the part as it turns and deforms. In the world they stand still.
#pragma once

#include <vector>

#include <pliant/body/points.h>
#include <pliant/math/functions.h>

namespace pliant {

struct MaterialFrame {
  static constexpr int points = 4;
  Mat3<double> K = Mat3<double>::Identity();  ///< axes = (x_1 - x_0, x_2 - x_0, x_3 - x_0) K + still, 1/m
  Mat3<double> still = Mat3<double>::Zero();  ///< of a frame of the world

  /// The axes in the world, as columns. x: the four points.
  template <class T>
  Mat3<T> at(const Vec3<T>* x) const {
    if (!still.isZero(0)) return still.cast<T>();
    Mat3<T> D, E;
    for (int k = 0; k < 3; ++k) D.col(k) = x[k + 1] - x[0];
    for (int c = 0; c < 3; ++c)
      E.col(c) = D.col(0) * T(K(0, c)) + D.col(1) * T(K(1, c)) + D.col(2) * T(K(2, c));
    const Vec3<T> first = E.col(0) / math::sqrt(T(E.col(0).dot(E.col(0))));
    const Vec3<T> across = E.col(1) - first * first.dot(E.col(1));
    const Vec3<T> second = across / math::sqrt(T(across.dot(across)));
    E.col(0) = first;
    E.col(1) = second;
    E.col(2) = first.cross(second);
    return E;
  }
};

struct FramedPoint {
  std::vector<Point> points;  ///< x_0 ... x_3
  MaterialFrame frame;
};

/// The frame at a point whose axes are the columns of a rotation: in the frame of its part at rest, or in the
/// world. The part must be prepared. Throws std::invalid_argument when the part has no extent there.
FramedPoint framed(const Point& at, const Mat3<double>& axes);

/// A rotation whose first column is a direction, of any length > 0.
Mat3<double> axes_along(const Vec3<double>& direction);

}  // namespace pliant
