#include <pliant/io/mesh_frames.h>

#include <pliant/io/format/obj.h>
#include <pliant/io/format/ply.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/frame_meshes.h>
#include <pliant/io/run/run_files.h>

namespace pliant {

void write_mesh_frames(const std::filesystem::path& folder, MeshFormat format, const Scene& scene,
                       const Model& model, const Recording& recording, double frame_rate,
                       const std::vector<std::int64_t>& frames, Progress& progress) {
  // An .obj file cannot store the values of the colouring.
  FrameMeshes meshes(
      scene, model, format == MeshFormat::obj ? FrameMeshes::Values::omitted : FrameMeshes::Values::included);
  progress.begin("meshes", static_cast<double>(frames.size()), "frames");
  double done = 0;
  for (const std::int64_t frame : frames) {
    const std::vector<NamedMesh>& now = meshes.at(recording.at(static_cast<double>(frame) / frame_rate));
    if (format == MeshFormat::obj)
      write_obj(folder / frame_name("frame", frame, "obj"), now, kMaterialFile);
    else
      write_ply(folder / frame_name("frame", frame, "ply"), now,
                scene.coloring ? quantity_info(scene.coloring->by).name : "");
    progress.advance(++done);
  }
  if (format == MeshFormat::obj) {
    std::vector<NamedMesh> colors;
    for (std::size_t i = 0; i < scene.appearance.size(); ++i)
      if (scene.appearance[i].visible)
        colors.push_back({scene.body.parts()[i]->name(), scene.appearance[i].color, {}});
    for (std::size_t i = 0; i < scene.obstacles.size(); ++i)
      if (scene.obstacles[i].visible)
        colors.push_back({scene.body.contact.obstacles[i].name, scene.obstacles[i].color, {}});
    for (const PlaneLook& look : scene.planes)
      colors.push_back({scene.body.contact.planes.at(look.plane).name, look.color, {}});
    const std::string text = mtl_text(colors);
    write_whole_file(folder / kMaterialFile, text.data(), text.size());
  }
  progress.end();
}

}  // namespace pliant
