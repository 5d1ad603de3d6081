// The triangle mesh of a part for contact search, and the edges of this mesh.
#include <pliant/collision/mesh/contact_mesh.h>

#include <map>
#include <utility>

#include <pliant/collision/mesh/sparse_surface.h>
#include <pliant/part/mesh/surface.h>

namespace pliant {

namespace {
/// Resolution of curved regions of the mesh of a part without nodes; Surface explains the resolution for
/// balls and tori.
constexpr int kMeshResolution = 6;
/// reach() and speed() of a part without nodes and with dynamic parameters use the vertices of a coarse mesh
/// with the resolution kCoarseMeshEdges, and multiply the largest value by kCoarseMeshMargin.
constexpr int kCoarseMeshEdges = 2;
constexpr double kCoarseMeshMargin = 1.1;
}  // namespace

std::vector<ContactMesh::Edge> mesh_edges(const Eigen::Matrix3Xi& triangles) {
  std::vector<ContactMesh::Edge> edges;
  std::map<std::pair<int, int>, std::size_t> known;  // edge number by its two vertices, the smaller first
  for (int t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int from = triangles(k, t), to = triangles((k + 1) % 3, t);
      const auto [place, added] = known.insert({std::minmax(from, to), edges.size()});
      if (added)
        edges.push_back({from, to, t, -1});
      else
        edges[place->second].right = t;
    }
  return edges;
}

ContactMesh::ContactMesh(const PartModel& m, double cell) : part_(&m) {
  Eigen::Matrix3Xd p;
  if (m.local != nullptr) {
    const LocalMesh& mesh = m.local->mesh();
    const SurfaceNodes surface = surface_nodes(mesh);
    nodes_ = surface.node;
    triangles_ = surface.triangles;
    p = surface.of(mesh.X);
    if (m.n_s == 0) {
      const Eigen::Matrix3Xd all = m.part->s(mesh.nodes, m.part->parameters().rest());
      rest_.resize(3, static_cast<Eigen::Index>(nodes_.size()));
      for (Eigen::Index k = 0; k < rest_.cols(); ++k)
        rest_.col(k) = all.col(nodes_[static_cast<std::size_t>(k)]);
    }
  } else {
    const Surface surface = sparse_surface(*m.part, kMeshResolution, cell);
    material_ = surface.material();
    triangles_ = surface.triangles();
    p = m.part->s(material_, m.part->parameters().rest());
    if (m.n_s == 0 || m.q0 < 0)
      rigid_ = p;
    else
      coarse_ = Surface(*m.part, kCoarseMeshEdges).material();
  }
  if (rigid_.cols() > 0) rigid_reach_ = rigid_.colwise().norm().maxCoeff();
  edges_ = mesh_edges(triangles_);
  for (const Edge& edge : edges_)
    mean_edge_ += (p.col(edge.to) - p.col(edge.from)).norm() / static_cast<double>(edges_.size());
  thickness_ = (p.rowwise().maxCoeff() - p.rowwise().minCoeff()).minCoeff();
}

Eigen::Matrix3Xd ContactMesh::positions(const Model& model, const State& state, int number) const {
  if (rigid_.cols() > 0) return rigid_;
  if (part_->local == nullptr) {
    const auto q_s = state.q.segment(part_->q0 + 7, part_->n_s);
    if (last_q_s_.size() == 0 || last_q_s_ != q_s)
      last_ = part_->part->s(material_, model.values(state, number));
    last_q_s_ = q_s;
    return last_;
  }
  const bool at_rest = rest_.cols() > 0;
  const Nodes all = at_rest ? part_->local->displacements(state.q.data() + part_->q0 + 7)
                            : model.node_positions(state, number);
  Eigen::Matrix3Xd p(3, static_cast<Eigen::Index>(nodes_.size()));
  for (Eigen::Index k = 0; k < p.cols(); ++k)
    p.col(k) = all.row(nodes_[static_cast<std::size_t>(k)]).transpose();
  if (at_rest) p += rest_;
  return p;
}

double ContactMesh::reach(const Model& model, const State& state, int number) const {
  if (rigid_.cols() > 0) return rigid_reach_;
  if (!coarse_.empty())
    return kCoarseMeshMargin *
           part_->part->s(coarse_, model.values(state, number)).colwise().norm().maxCoeff();
  return positions(model, state, number).colwise().norm().maxCoeff();
}

double ContactMesh::speed(const State& state) const {
  if (part_->q0 < 0) return 0;
  const PartModel& m = *part_;
  double speed = 0;
  if (m.n_s > 0) {
    VecMax<Dual<1>> q_s(m.n_s), q_s_dot(m.n_s);
    for (int k = 0; k < m.n_s; ++k) {
      q_s_dot[k] = state.v[m.v0 + 6 + k];
      q_s[k].v = state.q[m.q0 + 7 + k];
      q_s[k].d[0] = state.v[m.v0 + 6 + k];
    }
    speed = (coarse_.empty() ? 1 : kCoarseMeshMargin) *
            m.part
                ->s_along(m.local != nullptr ? m.local->mesh().nodes : coarse_,
                          m.part->parameters().expand<Dual<1>>(q_s, q_s_dot))
                .colwise()
                .norm()
                .maxCoeff();
  }
  if (m.local != nullptr)
    speed += m.local->displacements(state.v.data() + m.v0 + 6 + m.n_s).rowwise().norm().maxCoeff();
  return speed;
}

}  // namespace pliant
