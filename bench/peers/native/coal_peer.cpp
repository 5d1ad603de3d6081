// Distance queries of coal for the poses of bench/pair_bench.cpp.
//
//   coal_peer POSES.csv
//
// POSES.csv: pair_poses.csv of pair_bench. Prints for each pair and band: the pair, the band, the nanoseconds
// of a cold and of a warm query, and the largest difference of the gap from that of pliant, m. Queries are
// signed distances with the default tolerances. Cold queries start GJK with the default guess, and successive
// cold queries are at poses of different sequences. Warm queries are at successive poses of a sequence, and
// start GJK with the guess that the last query returned.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <coal/distance.h>
#include <coal/shape/geometric_shapes.h>

namespace {

constexpr double kBatch = 0.01;  // least time of a batch of queries, s
constexpr int kBatches = 10;

struct Query {
  int sequence;
  coal::Transform3s a, b;
  double gap;  // of pliant, m
};

struct Group {
  std::string pair, band;
  std::unique_ptr<coal::ShapeBase> a, b;
  std::vector<Query> queries;
};

std::unique_ptr<coal::ShapeBase> shape(const std::vector<std::string>& cells, std::size_t first) {
  const std::string& name = cells[first];
  const double x = std::stod(cells[first + 1]), y = std::stod(cells[first + 2]),
               z = std::stod(cells[first + 3]);
  if (name == "ellipsoid") return std::make_unique<coal::Ellipsoid>(x, y, z);
  if (name == "capsule") return std::make_unique<coal::Capsule>(x, 2 * z);
  if (name == "cylinder") return std::make_unique<coal::Cylinder>(x, 2 * z);
  if (name == "cone") return std::make_unique<coal::Cone>(x, 2 * z);
  throw std::runtime_error("unknown shape " + name);
}

coal::Transform3s place(const std::vector<std::string>& cells, std::size_t first) {
  double x[7];
  for (std::size_t i = 0; i < 7; ++i) x[i] = std::stod(cells[first + i]);
  return {Eigen::Quaterniond(x[3], x[4], x[5], x[6]).toRotationMatrix(), Eigen::Vector3d(x[0], x[1], x[2])};
}

std::vector<Group> read(const std::string& path) {
  std::ifstream file(path);
  std::string line, cell;
  if (!std::getline(file, line)) throw std::runtime_error("cannot read " + path);
  std::vector<Group> groups;
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    for (std::istringstream row(line); std::getline(row, cell, ',');) cells.push_back(cell);
    if (groups.empty() || groups.back().pair != cells.at(0) || groups.back().band != cells.at(1))
      groups.push_back({cells.at(0), cells.at(1), shape(cells, 3), shape(cells, 7), {}});
    groups.back().queries.push_back(
        {std::stoi(cells.at(2)), place(cells, 11), place(cells, 18), std::stod(cells.at(25))});
  }
  return groups;
}

/// Returns the queries in an order in which successive queries belong to different sequences.
std::vector<Query> shuffled(const std::vector<Query>& queries) {
  const std::size_t sequences = static_cast<std::size_t>(queries.back().sequence) + 1,
                    poses = queries.size() / sequences;
  std::vector<Query> result;
  for (std::size_t i = 0; i < queries.size(); ++i)
    result.push_back(queries[i % sequences * poses + i / sequences]);
  return result;
}

/// Returns the least time of a query over the batches, in nanoseconds.
double nanoseconds(const coal::ComputeDistance& distance, const std::vector<Query>& queries, bool warm) {
  coal::DistanceRequest request;
  request.gjk_initial_guess = warm ? coal::GJKInitialGuess::CachedGuess : coal::GJKInitialGuess::DefaultGuess;
  double least = 1e300;
  volatile double sink = 0;
  for (int batch = 0; batch < kBatches; ++batch) {
    const std::clock_t start = std::clock();
    double seconds = 0;
    long count = 0;
    while (seconds < kBatch) {
      for (const Query& query : queries) {
        coal::DistanceResult result;
        sink = sink + distance(query.a, query.b, request, result);
        request.updateGuess(result);
      }
      count += static_cast<long>(queries.size());
      seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    }
    least = std::min(least, 1e9 * seconds / static_cast<double>(count));
  }
  return least;
}

double largest_difference(const coal::ComputeDistance& distance, const std::vector<Query>& queries) {
  double largest = 0;
  for (const Query& query : queries) {
    coal::DistanceResult result;
    largest =
        std::max(largest, std::abs(distance(query.a, query.b, coal::DistanceRequest(), result) - query.gap));
  }
  return largest;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: coal_peer POSES.csv\n");
    return 2;
  }
  for (const Group& group : read(argv[1])) {
    const coal::ComputeDistance distance(group.a.get(), group.b.get());
    std::printf("%s,%s,%.1f,%.1f,%.3e\n", group.pair.c_str(), group.band.c_str(),
                nanoseconds(distance, shuffled(group.queries), false),
                nanoseconds(distance, group.queries, true), largest_difference(distance, group.queries));
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
