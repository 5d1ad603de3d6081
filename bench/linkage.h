// Linkages for benchmarks: rigid or deformable links connected by ball joints, in SI units, with gravity
// along -z.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/pliant.h>

namespace pliant::bench {

/// Semi-axes of a link and the length of its long axis, m.
inline const Vec3<double> kLinkAxes{0.3, 0.2, 0.1};
inline constexpr double kLinkLength = 0.6;
/// Radius of the spheres of a net, m.
inline constexpr double kNetRadius = 0.1;

/// Adds parts and joints to a MultiBody. The names of parts and joints contain consecutive numbers.
class Linkage {
 public:
  /// soft: whether the semi-axes of links are dynamic. with_joints: whether connect() adds joints; without
  /// joints the parts move independently.
  explicit Linkage(MultiBody& body, bool soft = false, bool with_joints = true)
      : body_(body), soft_(soft), with_joints_(with_joints) {}

  /// Adds an ellipsoid whose long axis has the direction of the first axis of R. near: position of the end of
  /// this axis at -a1 (the near tip), world, m.
  Part& link(const Vec3<double>& near, const Eigen::Quaterniond& R) {
    auto& part = body_.add<Primitive<Ellipsoid>>("part" + std::to_string(body_.parts().size()));
    part.rest({{"a1", kLinkAxes[0]}, {"a2", kLinkAxes[1]}, {"a3", kLinkAxes[2]}});
    if (soft_) part.stiffness({{"a1", 1e5}, {"a2", 1e5}, {"a3", 1e5}});
    return part.place(near + R * Vec3<double>(kLinkAxes[0], 0, 0), R);
  }
  Part& sphere(const Vec3<double>& c, double radius) {
    auto& part = body_.add<Primitive<Sphere>>("part" + std::to_string(body_.parts().size()));
    part.rest({{"r", radius}});
    return part.place(c);
  }
  void connect(const Point& a, const Point& b) {
    if (with_joints_) body_.ball("joint" + std::to_string(body_.joints().size()), a, b);
  }

  static Point near_tip(const Part& link) { return point(link, 0, kPi); }
  static Point far_tip(const Part& link) { return point(link, 0, 0); }

 private:
  MultiBody& body_;
  bool soft_, with_joints_;
};

/// Adds a chain of n links at rest that begins at the origin, along x or hanging down. Link i is rotated by
/// 0.7 i rad about its long axis.
inline void chain(Linkage& linkage, int n, bool hanging = false) {
  const Eigen::Quaterniond along(Eigen::AngleAxisd(hanging ? kPi / 2 : 0, Vec3<double>::UnitY()));
  const Part* previous = nullptr;
  for (int i = 0; i < n; ++i) {
    const Eigen::Quaterniond roll(Eigen::AngleAxisd(0.7 * i, Vec3<double>::UnitX()));
    const Part& link = linkage.link(along * Vec3<double>(kLinkLength * i, 0, 0), along * roll);
    linkage.connect(previous == nullptr ? world(0, 0, 0) : Linkage::far_tip(*previous),
                    Linkage::near_tip(link));
    previous = &link;
  }
}

/// Adds n links as a binary tree that begins at the origin: links 2i + 1 and 2i + 2 are connected to the far
/// tip of link i.
inline void tree(Linkage& linkage, int n) {
  struct Node {
    const Part* part;
    Eigen::Quaterniond R;
  };
  std::vector<Node> nodes;
  for (int i = 0; i < n; ++i) {
    if (i == 0) {
      const Part& root = linkage.link(Vec3<double>::Zero(), Eigen::Quaterniond::Identity());
      linkage.connect(world(0, 0, 0), Linkage::near_tip(root));
      nodes.push_back({&root, Eigen::Quaterniond::Identity()});
      continue;
    }
    const Node& parent = nodes[static_cast<std::size_t>((i - 1) / 2)];
    const Eigen::AngleAxisd bend(i % 2 == 0 ? 0.5 : -0.5, Vec3<double>::UnitZ());
    const Eigen::Quaterniond R = parent.R * bend * Eigen::AngleAxisd(kPi / 2, Vec3<double>::UnitX());
    const Part& link =
        linkage.link(parent.part->c0() + parent.R * Vec3<double>(kLinkAxes[0], 0, 0), R.normalized());
    linkage.connect(Linkage::far_tip(*parent.part), Linkage::near_tip(link));
    nodes.push_back({&link, R.normalized()});
  }
}

/// Adds n links as the sides of a regular polygon in a vertical plane. A ball joint connects one corner of
/// the polygon with the origin.
inline void ring(Linkage& linkage, int n) {
  std::vector<const Part*> links;
  Vec3<double> corner = Vec3<double>::Zero();
  for (int i = 0; i < n; ++i) {
    const Eigen::Quaterniond R(Eigen::AngleAxisd(2 * kPi * (i + 0.5) / n, Vec3<double>::UnitY()));
    links.push_back(&linkage.link(corner, R));
    corner += R * Vec3<double>(kLinkLength, 0, 0);
  }
  linkage.connect(world(0, 0, 0), Linkage::near_tip(*links.front()));
  for (std::size_t i = 0; i < links.size(); ++i)
    linkage.connect(Linkage::far_tip(*links[i]), Linkage::near_tip(*links[(i + 1) % links.size()]));
}

/// Adds a sphere whose centre is joined to the origin, and n links that point outwards. Ball joints connect
/// the links with points all over the surface of the sphere.
inline void star(Linkage& linkage, int n) {
  const double radius = 0.3;
  const Part& hub = linkage.sphere(Vec3<double>::Zero(), radius);
  linkage.connect(world(0, 0, 0), point(hub, 0, 0, 0));
  const double golden = kPi * (3 - std::sqrt(5.0));
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2.0 * i + 1) / n, s = std::sqrt(1 - z * z);
    const Vec3<double> direction(s * std::cos(golden * i), s * std::sin(golden * i), z);
    const Part& arm = linkage.link(radius * direction,
                                   Eigen::Quaterniond::FromTwoVectors(Vec3<double>::UnitX(), direction));
    linkage.connect(point(hub, material_towards(direction)), Linkage::near_tip(arm));
  }
}

/// Adds n x n touching spheres on a wavy surface (a flat net is singular). Ball joints connect each sphere
/// with its neighbours at the contact points, and two corner spheres with the world.
inline void net(Linkage& linkage, int n) {
  const auto size = static_cast<std::size_t>(n);
  auto along_x = [](int i) {
    const double slope = 0.5 * std::sin(1 + 1.7 * i);
    return Vec3<double>(std::cos(slope), 0, std::sin(slope));
  };
  auto along_y = [](int j) {
    const double slope = 0.4 * std::cos(0.5 + 1.3 * j);
    return Vec3<double>(0, std::cos(slope), std::sin(slope));
  };
  std::vector<const Part*> spheres;
  Vec3<double> row = Vec3<double>::Zero();
  for (int i = 0; i < n; ++i) {
    Vec3<double> c = row;
    for (int j = 0; j < n; ++j) {
      spheres.push_back(&linkage.sphere(c, kNetRadius));
      c += 2 * kNetRadius * along_y(j);
    }
    row += 2 * kNetRadius * along_x(i);
  }
  for (const std::size_t corner : {std::size_t{0}, size - 1}) {
    const Vec3<double> pin = spheres[corner]->c0() - Vec3<double>(kNetRadius, 0, 0);
    linkage.connect(world(pin[0], pin[1], pin[2]), Linkage::near_tip(*spheres[corner]));
  }
  auto touch = [&](std::size_t a, std::size_t b, const Vec3<double>& direction) {
    linkage.connect(point(*spheres[a], material_towards(direction)),
                    point(*spheres[b], material_towards(-direction)));
  };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const auto k = static_cast<std::size_t>(i * n + j);
      if (i + 1 < n) touch(k, k + size, along_x(i));
      if (j + 1 < n) touch(k, k + 1, along_y(j));
    }
}

}  // namespace pliant::bench
