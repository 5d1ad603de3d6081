// The set-up of distributed forces: the ports at which they act, and the masses or triangles of these ports.
#include <stdexcept>

#include <pliant/body/model.h>
#include <pliant/part/mesh/surface.h>

namespace pliant {

namespace {

Trig<double> lane(const Trig<Pack>& four, int i) {
  return {four.x[i], four.sign[i], four.log_abs[i]};
}
Material<double> lane(const Material<Pack>& four, int i) {
  return {lane(four.cu, i), lane(four.su, i), lane(four.cv, i), lane(four.sv, i), four.w[i]};
}

/// Material points with the triangles or the masses (kg) that they carry.
struct Points {
  std::vector<Material<double>> at;
  Eigen::Matrix3Xi triangles;
  VecX<double> mass;
};

Points surface_points(const Part& part, int resolution) {
  if (part.local() == nullptr) {
    const Surface surface(part, resolution);
    return {surface.material(), surface.triangles(), {}};
  }
  const LocalMesh& mesh = part.local()->mesh();
  const SurfaceNodes nodes = surface_nodes(mesh);
  Points points{{}, nodes.triangles, {}};
  for (const int node : nodes.node) points.at.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
  return points;
}

/// Returns the nodes of a part that deforms locally, and otherwise its mass points.
Points body_points(const Part& part) {
  if (part.local() != nullptr) return {part.local()->mesh().nodes, {}, part.local()->mesh().mass};
  const MassPoints& rule = part.mass_points();
  if (rule.n_points == 0)
    throw std::invalid_argument("acts on part '" + part.name() +
                                "', whose \"inertia\" does not say where its mass is; give a density");
  Points points{{}, {}, VecX<double>(rule.n_points)};
  for (int k = 0; k < rule.n_points; ++k) {
    const auto pack = static_cast<std::size_t>(k / Pack::kLanes);
    const int i = k % static_cast<int>(Pack::kLanes);
    points.at.push_back(lane(rule.at[pack], i));
    points.mass[k] = rule.mass[pack][i];
  }
  return points;
}

}  // namespace

void Model::add_distributed_forces() {
  for (const auto& force : body_->distributed_forces()) {
    const std::string what = "distributed force '" + force->name + "'";
    if (force->part == nullptr) throw std::invalid_argument(what + " acts on no part");
    if (!moves(force->part)) continue;
    DistributedModel m;
    m.force = force.get();
    m.part = number_of(*force->part);
    PartModel& part = parts_[static_cast<std::size_t>(m.part)];
    m.first_port = static_cast<int>(part.ports.size());
    Points points;
    try {
      points = force->domain == DistributedForce::Domain::body
                   ? body_points(*force->part)
                   : surface_points(*force->part, force->resolution);
    } catch (const std::invalid_argument& fault) {
      throw std::invalid_argument(what + ": " + fault.what());
    }
    m.triangles = std::move(points.triangles);
    m.mass = std::move(points.mass);
    // Mass points may be outside of the body (w > 1): a few points have the moments of many.
    part.ports.insert(part.ports.end(), points.at.begin(), points.at.end());
    part.port_place.resize(part.ports.size(), -1);
    if (part.local != nullptr)
      for (const Material<double>& at : points.at)
        part.node_weights.push_back(node_weights(point(*part.part, at)));
    Counters unused;
    std::vector<PointJet<double>> rest;
    force->part->points(points.at, part.rest, VecMax<double>::Zero(part.n_s), rest, unused);
    m.X.resize(3, static_cast<Eigen::Index>(rest.size()));
    for (std::size_t k = 0; k < rest.size(); ++k) m.X.col(static_cast<Eigen::Index>(k)) = rest[k].p;
    distributed_forces_.push_back(std::move(m));
  }
}

void Model::resolve_distributed_forces() {
  for (DistributedModel& m : distributed_forces_) {
    const std::string what = "distributed force '" + m.force->name + "'";
    for (std::size_t k = 0; k < 3; ++k) m.density[k] = resolve(m.force->density.component[k], what);
    m.pressure = resolve(m.force->pressure, what);
    for (const StateFunction& component : m.force->density.component)
      m.has_density = m.has_density || !component.is_constant() || component.constant() != 0;
  }
}

}  // namespace pliant
