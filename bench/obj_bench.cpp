// Time of writing mesh files of a hundred thousand triangles with normals. Prints one CSV row for each
// format. The target for OBJ is 20 ms.
//
//   obj_bench [ROUNDS] [FOLDER]     ROUNDS: number of measurements (default: 20); FOLDER: folder of the
//   temporary files (default: the temporary folder of the system)
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <pliant/io/format/obj.h>
#include <pliant/io/format/ply.h>
#include <pliant/part/registry.h>

namespace {

struct Times {
  double median, min;  // ms
};

Times measure(int rounds, const std::function<void()>& task) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> ms;
  for (int i = 0; i <= rounds; ++i) {  // the first round fills the caches and is not measured
    const Clock::time_point start = Clock::now();
    task();
    if (i > 0) ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  std::sort(ms.begin(), ms.end());
  return {ms[ms.size() / 2], ms[0]};
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 20;
  const std::filesystem::path folder = argc > 2 ? argv[2] : std::filesystem::temp_directory_path();
  const auto part = pliant::make_part("solid", "superellipsoid", {"taper", "twist"}, 1000);
  part->rest({{"eps1", 0.7}, {"taper.tx", 0.2}, {"twist.angle", 0.5}});
  const pliant::Surface surface(*part, pliant::Surface::resolution_for(*part, 100000));
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, 0.4, -0.5, 0.7).normalized();
  const std::vector<pliant::NamedMesh> meshes{
      {"solid", {}, surface.world_mesh(*part, part->parameters().rest(), {0.3, -1.2, 2.7}, turn)}};
  const long triangles = static_cast<long>(surface.triangles().cols());

  std::printf("bench,format,triangles,vertices,megabytes,median_ms,least_ms\n");
  const auto row = [&](const char* format, const std::function<void(const std::filesystem::path&)>& write) {
    const std::filesystem::path file = folder / (std::string("pliant_bench.") + format);
    const Times ms = measure(rounds, [&] { write(file); });
    std::printf("mesh_file,%s,%ld,%ld,%.2f,%.2f,%.2f\n", format, triangles,
                static_cast<long>(meshes[0].mesh.x.cols()),
                static_cast<double>(std::filesystem::file_size(file)) / 1e6, ms.median, ms.min);
    std::filesystem::remove(file);
  };
  row("obj", [&](const std::filesystem::path& file) { pliant::write_obj(file, meshes); });
  row("ply", [&](const std::filesystem::path& file) { pliant::write_ply(file, meshes); });
}
