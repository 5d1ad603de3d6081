// Any bytes are a mesh or are refused with a message: there is no other exception, no crash and no hang. The
// files of a cube in all formats are cut at every byte and mutated in the same ways in each run of the test.
#include "catch.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/scene/json/text_file.h>
#include <pliant/scene/mesh_file.h>

#include "mesh_samples.h"

namespace mesh_fuzz_test {

using namespace pliant;
using mesh_samples::Sample;

namespace {

#ifdef PLIANT_SANITIZED
constexpr int kEach = 8;  // builds with sanitizers run one in kEach cases
#else
constexpr int kEach = 1;
#endif

/// Numbers of meshes that were read and refused, and the longest time of a case.
struct Outcomes {
  int meshes = 0, refused = 0;
  double slowest = 0;  // s
};

/// Reads a mesh. Checks that an accepted mesh is finite and that its triangles refer to its vertices.
void read_any(const std::string& name, const std::string& bytes, Outcomes& outcomes) {
  const auto start = std::chrono::steady_clock::now();
  try {
    const MeshFile mesh = read_mesh(name, bytes);
    ++outcomes.meshes;
    CHECK(mesh.vertices.allFinite());
    CHECK(mesh.triangles.minCoeff() >= 0);
    CHECK(mesh.triangles.maxCoeff() < mesh.vertices.cols());
    const ObstacleMesh obstacle(mesh.vertices, mesh.triangles);
  } catch (const std::invalid_argument& fault) {
    ++outcomes.refused;
    CHECK(std::string(fault.what()).size() > 10);
  } catch (const FileError&) {
    ++outcomes.refused;
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  outcomes.slowest = std::max(outcomes.slowest, taken.count());
}

/// Returns the bytes with one to four random changes: of a bit, a byte, a number, or a range.
std::string mutated(std::string bytes, std::mt19937& random) {
  static const std::vector<std::string> odd{"-1",
                                            "0",
                                            "1e400",
                                            "nan",
                                            "4294967295",
                                            "1,5",
                                            "/",
                                            "\xff\xff\xff\x7f",
                                            std::string(4, '\0'),
                                            "\n",
                                            " ",
                                            "{",
                                            "]",
                                            "e",
                                            "0x1p3",
                                            "999999999999999999999"};
  const auto below = [&](std::size_t n) { return n == 0 ? std::size_t{0} : random() % n; };
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t at = below(bytes.size() + 1), length = std::min(below(20), bytes.size() - at);
    switch (below(6)) {
      case 0:
        if (at < bytes.size()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
        break;
      case 1:
        bytes.insert(at, odd[below(odd.size())]);
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(below(bytes.size() + 1), below(40)));
        break;
      case 4:
        bytes.replace(at, length, odd[below(odd.size())]);
        break;
      default:
        if (below(3) == 0) bytes.resize(at);
    }
  }
  return bytes;
}

/// Reads of_each / kEach mutated files of each format.
void run_mutations(int of_each, Outcomes& outcomes) {
  for (const Sample& sample : mesh_samples::cubes()) {
    std::seed_seq seed(sample.name.begin(), sample.name.end());
    std::mt19937 random(seed);
    for (int i = 0; i < of_each / kEach; ++i) read_any(sample.name, mutated(sample.bytes, random), outcomes);
  }
}

}  // namespace

TEST_CASE("mesh files that end at any byte are refused or read") {
  Outcomes outcomes;
  for (const Sample& sample : mesh_samples::cubes())
    for (std::size_t n = 0; n < sample.bytes.size(); n += kEach)
      read_any(sample.name, sample.bytes.substr(0, n), outcomes);
  CHECK(outcomes.refused > 2000 / kEach);
  CHECK(outcomes.slowest < 10);
}

TEST_CASE("mutated mesh files are refused with a message or read") {
  Outcomes outcomes;
  run_mutations(400, outcomes);
  CHECK(outcomes.meshes > 300 / kEach);
  CHECK(outcomes.refused > 1500 / kEach);
  CHECK(outcomes.slowest < 10);
}

TEST_CASE("many mutated mesh files are refused with a message or read", "[long]") {
  Outcomes outcomes;
  run_mutations(20000, outcomes);
  CHECK(outcomes.meshes > 15000 / kEach);
  CHECK(outcomes.refused > 75000 / kEach);
  CHECK(outcomes.slowest < 10);
}

}  // namespace mesh_fuzz_test
