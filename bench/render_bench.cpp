// Time of a picture of 20 bodies of about 1000 triangles each, with shadows and with new vertices in each
// frame. Prints one CSV row for each picture size, with the times of drawing, of writing the PNG, and of
// both. The target for 640x480 with PNG is 45 ms (two raster threads).
//
//   render_bench [FRAMES] [FOLDER]     FRAMES: number of frames of 640x480 (default: 40); a quarter as many
//   frames of 1920x1080 are drawn; FOLDER: receives the last picture of each size (default: the temporary
//   folder of the system)
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include <pliant/io/format/png.h>
#include <pliant/render/renderer.h>

namespace {

constexpr double kPi = 3.14159265358979323846;

double signed_power(double x, double e) {
  return std::copysign(std::pow(std::abs(x), e), x);
}

// Returns a superellipsoid of 2 * columns * (rows - 1) triangles, with one vertex at each pole. a: semi-axes.
pliant::TriangleMesh superellipsoid(int rows, int columns, double eps1, double eps2,
                                    const Eigen::Vector3d& a) {
  const int rings = rows - 1, poles = rings * columns;
  pliant::TriangleMesh mesh;
  mesh.x.resize(3, poles + 2);
  mesh.normals.resize(3, poles + 2);
  const auto set = [&](int i, double u, double v) {
    const double cu = std::cos(u), su = std::sin(u), cv = std::cos(v), sv = std::sin(v);
    mesh.x.col(i) << a[0] * signed_power(cu, eps1) * signed_power(cv, eps2),
        a[1] * signed_power(cu, eps1) * signed_power(sv, eps2), a[2] * signed_power(su, eps1);
    mesh.normals.col(i) << signed_power(cu, 2 - eps1) * signed_power(cv, 2 - eps2) / a[0],
        signed_power(cu, 2 - eps1) * signed_power(sv, 2 - eps2) / a[1], signed_power(su, 2 - eps1) / a[2];
    mesh.normals.col(i).normalize();
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < columns; ++j)
      set(i * columns + j, kPi * ((i + 1.0) / rows - 0.5), 2 * kPi * j / columns);
  set(poles, -kPi / 2, 0);
  set(poles + 1, kPi / 2, 0);
  std::vector<Eigen::Vector3i> triangles;
  for (int j = 0; j < columns; ++j) {
    const int k = (j + 1) % columns, last = (rings - 1) * columns;
    triangles.emplace_back(poles, k, j);
    triangles.emplace_back(poles + 1, last + j, last + k);
    for (int i = 0; i + 1 < rings; ++i) {
      const int low = i * columns, high = low + columns;
      triangles.emplace_back(low + j, low + k, high + k);
      triangles.emplace_back(low + j, high + k, high + j);
    }
  }
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  mesh.corners = mesh.triangles;
  return mesh;
}

// Returns the meshes of 4 x 5 bodies that rotate and hop, at time t (s). rest: the meshes in body frames.
std::vector<pliant::TriangleMesh> placed(const std::vector<pliant::TriangleMesh>& rest, double t) {
  std::vector<pliant::TriangleMesh> now = rest;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const double k = static_cast<double>(i);
    const Eigen::Matrix3d rotation =
        Eigen::AngleAxisd(0.4 * t + k, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector3d centre(1.3 * static_cast<double>(i % 5) - 2.6,
                                 1.3 * static_cast<double>(i / 5) - 1.95,
                                 0.5 + 0.3 * std::abs(std::sin(t + k)));
    now[i].x = (rotation * rest[i].x).colwise() + centre;
    now[i].normals = rotation * rest[i].normals;
  }
  return now;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

void measure(int width, int height, int frames, const std::filesystem::path& file) {
  using Clock = std::chrono::steady_clock;
  const auto ms = [](Clock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); };
  const Clock::time_point begin = Clock::now();
  pliant::Renderer renderer(width, height);
  const double open_ms = ms(Clock::now() - begin);

  std::vector<pliant::TriangleMesh> rest;
  for (int i = 0; i < 20; ++i)
    rest.push_back(superellipsoid(16, 34, 0.3 + 0.11 * (i % 9), 0.3 + 0.17 * (i % 7),
                                  {0.35 + 0.02 * (i % 4), 0.42 - 0.03 * (i % 3), 0.5}));
  std::vector<double> draw, png;
  double first_ms = 0;
  for (int frame = 0; frame <= frames; ++frame) {
    const std::vector<pliant::TriangleMesh> meshes = placed(rest, 0.05 * frame);
    pliant::Picture picture;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      const float hue = static_cast<float>(i) / 20;
      picture.bodies.push_back({&meshes[i], {0.35f + 0.5f * hue, 0.45f, 0.85f - 0.5f * hue}});
    }
    picture.camera = pliant::automatic_camera(
        Eigen::AlignedBox3d(Eigen::Vector3d(-3.1, -2.5, 0), Eigen::Vector3d(3.1, 2.5, 1.3)),
        static_cast<double>(width) / height);
    const Clock::time_point start = Clock::now();
    const pliant::Image image = renderer.draw(picture);
    const Clock::time_point drawn = Clock::now();
    pliant::write_png(image, file);
    const Clock::time_point written = Clock::now();
    if (frame == 0) {
      first_ms = ms(drawn - start);
      continue;
    }
    draw.push_back(ms(drawn - start));
    png.push_back(ms(written - drawn));
  }
  std::printf("render,%d,%d,20,%ld,%s,\"%s\",%.1f,%.1f,%.2f,%.2f,%.2f\n", width, height,
              20 * static_cast<long>(rest[0].triangles.cols()), renderer.backend().c_str(),
              renderer.device().c_str(), open_ms, first_ms, median(draw), median(png),
              median(draw) + median(png));
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::max(1, std::atoi(argv[1])) : 40;
  const std::filesystem::path folder = argc > 2 ? argv[2] : std::filesystem::temp_directory_path();
  std::printf(
      "bench,width,height,bodies,triangles,backend,device,open_ms,first_ms,draw_ms,png_ms,frame_ms\n");
  measure(640, 480, frames, folder / "pliant_render_bench_vga.png");
  measure(1920, 1080, std::max(1, frames / 4), folder / "pliant_render_bench_hd.png");
}
