// The set-up of distributed forces: the ports at which they act, and the masses or triangles of these ports.
#include <stdexcept>
#include <utility>

#include <pliant/body/model.h>
#include <pliant/part/mesh/surface.h>
#include <pliant/part/quadrature/body_points.h>

namespace pliant {

namespace {

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

/// Returns the nodes of the mesh if the mesh carries the mass of the part; otherwise points inside the part.
Points body_points(const Part& part, int resolution) {
  if (part.local() != nullptr && part.local()->mesh().mass.size() > 0)
    return {part.local()->mesh().nodes, {}, part.local()->mesh().mass};
  if (!has_known_masses(part))
    throw std::invalid_argument(
        "part '" + part.name() +
        "' has a given inertia, which does not say where its mass is; expected a part "
        "with a density or a mass");
  BodyPoints points = place_matched_body_points(part, resolution);
  return {std::move(points.at), {}, std::move(points.mass)};
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
    const bool in_body = force->domain == DistributedForce::Domain::body;
    const int standard = in_body ? DistributedForce::kBodyResolution : DistributedForce::kSurfaceResolution;
    const int resolution = force->resolution == 0 ? standard : force->resolution;
    if (resolution < (in_body ? 3 : 1) || resolution > DistributedForce::kMaxResolution)
      throw std::invalid_argument(what + " has the resolution " + std::to_string(resolution) +
                                  "; expected one from " + (in_body ? "3" : "1") + " to " +
                                  std::to_string(DistributedForce::kMaxResolution));
    Points points;
    try {
      points = in_body ? body_points(*force->part, resolution) : surface_points(*force->part, resolution);
    } catch (const std::invalid_argument& fault) {
      throw std::invalid_argument(what + ": " + fault.what());
    }
    m.triangles = std::move(points.triangles);
    m.mass = std::move(points.mass);
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
