#include <pliant/contact/node_motion.h>

#include <vector>

#include <Eigen/Geometry>

#include <pliant/part/part.h>

namespace pliant {

NodeMotion node_motion(const Model& model, const State& state, int part, int node) {
  const PartModel& m = model.parts()[static_cast<std::size_t>(part)];
  const LocalMesh& mesh = m.local->mesh();
  const Eigen::Index n = mesh.X.rows();
  const auto d = state.q.segment(m.q0 + 7 + m.n_s, m.n_d()),
             d_dot = state.v.segment(m.v0 + 6 + m.n_s, m.n_d());
  Vec3<double> p = mesh.X.row(node), u = Vec3<double>::Zero();
  if (m.n_s > 0) {
    std::vector<PointJet<double>> jets;
    Counters counters;
    m.part->points({mesh.nodes[static_cast<std::size_t>(node)]}, state.q.segment(m.q0 + 7, m.n_s),
                   state.v.segment(m.v0 + 6, m.n_s), jets, counters);
    p = jets[0].p;
    u = jets[0].p1;
  }
  p += Vec3<double>(d[node], d[node + n], d[node + 2 * n]);
  u += Vec3<double>(d_dot[node], d_dot[node + n], d_dot[node + 2 * n]);
  const Mat3<double> R = model.orientation(state, part).toRotationMatrix();
  const Vec3<double> omega = state.v.segment<3>(m.v0 + 3);
  return {model.position(state, part) + R * p, state.v.segment<3>(m.v0) + R * (omega.cross(p) + u)};
}

}  // namespace pliant
