// Velocities of mesh nodes: x_dot = c_dot + R (omega x p + s_dot + d_dot), Eq. (7).
#include <pliant/collision/mesh/node_motion.h>

#include <Eigen/Geometry>

#include <pliant/part/part.h>

namespace pliant {

void node_velocities(const Model& model, const State& state, int part, const std::vector<int>& nodes,
                     Eigen::Matrix3Xd& x_dot) {
  const PartModel& m = model.parts()[static_cast<std::size_t>(part)];
  const LocalMesh& mesh = m.local->mesh();
  const Eigen::Matrix3Xd d = m.local->displacements(state.q.data() + m.q0 + 7 + m.n_s, nodes),
                         d_dot = m.local->displacements(state.v.data() + m.v0 + 6 + m.n_s, nodes);
  std::vector<PointJet<double>> jets;
  if (m.n_s > 0) {
    std::vector<Material<double>> at;
    at.reserve(nodes.size());
    for (const int node : nodes) at.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
    Counters counters;
    m.part->points(at, state.q.segment(m.q0 + 7, m.n_s), state.v.segment(m.v0 + 6, m.n_s), jets, counters);
  }
  const Vec3<double> c_dot = state.v.segment<3>(m.v0), omega = state.v.segment<3>(m.v0 + 3);
  const Mat3<double> R = model.orientation(state, part).toRotationMatrix();
  x_dot.resize(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    Vec3<double> p = mesh.X.row(nodes[i]), u = Vec3<double>::Zero();
    if (m.n_s > 0) {
      p = jets[i].p;
      u = jets[i].p1;
    }
    p += d.col(k);
    u += d_dot.col(k);
    x_dot.col(k) = c_dot + R * (omega.cross(p) + u);
  }
}

}  // namespace pliant
