#include <pliant/local/shell/loaded_membrane.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include <pliant/local/solid/element_matrix.h>

namespace pliant {

namespace {

/// The triangles, after a look at their nodes.
const Eigen::Matrix3Xi& checked(const ParameterMesh& mesh) {
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.triangles(k, t) < 0 || mesh.triangles(k, t) >= mesh.n_nodes)
        throw std::invalid_argument("triangle " + std::to_string(t) + " of the parameter mesh names node " +
                                    std::to_string(mesh.triangles(k, t)) + "; there are " +
                                    std::to_string(mesh.n_nodes));
  if (mesh.uv.cols() != 3 * mesh.triangles.cols())
    throw std::invalid_argument("a parameter mesh needs (u, v) at each corner of each triangle");
  return mesh.triangles;
}

}  // namespace

LoadedMembrane::LoadedMembrane(const Eigen::Matrix3Xi& triangles, Eigen::Index n_nodes, const Load& load)
    : batches_(triangles, n_nodes), triangles_(static_cast<std::size_t>(batches_.n_batches())) {
  if (!(load.w0 >= 0) || !(load.w1 >= 0) || !std::isfinite(load.w0 + load.w1))
    throw std::invalid_argument("the weights w0 and w1 of a loaded membrane must not be negative");
}

LoadedMembrane::LoadedMembrane(const ParameterMesh& mesh, const Load& load)
    : LoadedMembrane(checked(mesh), mesh.n_nodes, load) {
  for (int b = 0; b < batches_.n_batches(); ++b)
    for (int lane = 0; lane < Pack::kLanes; ++lane) {
      const int t = batches_.element(b, lane);
      auto corner = [&](int k) { return Vec3<double>(mesh.uv(0, 3 * t + k), mesh.uv(1, 3 * t + k), 0); };
      const Edges<double> e = edges_of<double>({corner(0), corner(1), corner(2)});
      if (!(e[0].cross(e[1]).norm() > 0))
        throw std::invalid_argument("triangle " + std::to_string(t) + " of the parameter mesh has no area");
      set(b, lane, e, load);
    }
}

LoadedMembrane::LoadedMembrane(const ShellMesh& mesh, const Load& load)
    : LoadedMembrane(mesh.triangles(), mesh.n_nodes(), load) {
  for (int b = 0; b < batches_.n_batches(); ++b)
    for (int lane = 0; lane < Pack::kLanes; ++lane)
      set(b, lane, edges_of(mesh, batches_.element(b, lane)), load);
}

void LoadedMembrane::set(int b, int lane, const Edges<double>& e, const Load& load) {
  Triangle& triangle = triangles_[static_cast<std::size_t>(b)];
  const double twice_area = e[0].cross(e[1]).norm();
  for (std::size_t k = 0; k < 3; ++k)
    triangle.spring[k].set(lane, -0.5 * load.w1 * e[(k + 1) % 3].dot(e[(k + 2) % 3]) / twice_area);
  const double share = load.w0 * twice_area / 24;
  const bool lumped = load.size == Load::Size::lumped;
  triangle.alone.set(lane, lumped ? 4 * share : share);
  triangle.together.set(lane, lumped ? 0 : share);
}

LoadedMembrane::Corners LoadedMembrane::pull(int b, const Corners& d) const {
  const Triangle& triangle = triangles_[static_cast<std::size_t>(b)];
  const Vec3<Pack> all = triangle.together * (d[0] + d[1] + d[2]);
  const Corners springs = corner_forces(triangle.spring, edges_of(d));
  Corners pull;
  for (std::size_t k = 0; k < 3; ++k) pull[k] = all + triangle.alone * d[k] - springs[k];
  return pull;
}

double LoadedMembrane::energy(const Coordinates& x) const {
  double twice = 0;
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const Corners d = batches_.corners(x, b), f = pull(b, d);
    const Pack work = d[0].dot(f[0]) + d[1].dot(f[1]) + d[2].dot(f[2]);
    for (int lane = 0; lane < batches_.lanes(b); ++lane) twice += work[lane];
  }
  return 0.5 * twice;
}

void LoadedMembrane::add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer,
                               ThreadPool* pool) const {
  buffer.numbers.resize(batches_.buffer_size());
  batches_.add(f, buffer.numbers.data(), pool, [&](int b) {
    Corners force = pull(b, batches_.corners(x, b));
    for (Vec3<Pack>& at : force) at = -at;
    return force;
  });
}

void LoadedMembrane::add_derivative(const Coordinates&, const Coordinates& dx, VecX<double>& f,
                                    Buffer& buffer, ThreadPool* pool) const {
  add_force(dx, f, buffer, pool);
}

template <class Visit>
void LoadedMembrane::each_element(Visit&& visit) const {
  for (int b = 0; b < batches_.n_batches(); ++b) {
    const Triangle& triangle = triangles_[static_cast<std::size_t>(b)];
    for (int lane = 0; lane < batches_.lanes(b); ++lane) {
      Mat3<double> k = Mat3<double>::Constant(triangle.together[lane]);
      k.diagonal().array() += triangle.alone[lane];
      for (int edge = 0; edge < 3; ++edge) {
        const int i = (edge + 1) % 3, j = (edge + 2) % 3;
        const double spring = triangle.spring[static_cast<std::size_t>(edge)][lane];
        k(i, i) += spring;
        k(j, j) += spring;
        k(i, j) -= spring;
        k(j, i) -= spring;
      }
      ElementMatrix<9> element{batches_.coordinates(b, lane), Eigen::Matrix<double, 9, 9>::Zero()};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) element.K.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(k(i, j));
      visit(element);
    }
  }
}

void LoadedMembrane::add_stiffness(const Coordinates&, std::vector<Eigen::Triplet<double>>& K) const {
  add_triplets([&](auto&& visit) { each_element(visit); }, K);
}

double LoadedMembrane::frequency_bound(const Coordinates&, const VecX<double>& M) const {
  return largest_of_elements([&](auto&& visit) { each_element(visit); }, M);
}

}  // namespace pliant
