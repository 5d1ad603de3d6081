#include <pliant/body/distributed/distributed_force.h>

namespace pliant {

const std::vector<std::string>& quantities_at_points(DistributedForce::Domain domain) {
  static const std::vector<std::string> body{"x", "y", "z", "vx", "vy", "vz", "X", "Y", "Z"};
  static const std::vector<std::string> surface{"x", "y", "z",  "vx", "vy", "vz", "X",
                                                "Y", "Z", "nx", "ny", "nz", "vn"};
  return domain == DistributedForce::Domain::body ? body : surface;
}

}  // namespace pliant
