// Wavefront OBJ files: one group per mesh, vertex normals, colours through a material file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <pliant/io/frame_meshes.h>
#include <pliant/io/run/run_files.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

/// Returns the text of a file with these meshes: positions in the shortest form that reads back exactly,
/// normals with six decimals. material_file: name of the file with the colours; empty for none.
std::string obj_text(const std::vector<NamedMesh>& meshes, const std::string& material_file = "");
/// Returns the text of the material file: one material per mesh, with the name of the mesh.
std::string mtl_text(const std::vector<NamedMesh>& meshes);

/// Writes an OBJ file (whole or absent, see whole_file.h). Throws std::system_error.
void write_obj(const std::filesystem::path& path, const std::vector<NamedMesh>& meshes,
               const std::string& material_file = "");
/// Writes the surface of one part at the current state of a simulation, without a material file. Creates the
/// folders of the path.
void write_obj(const std::filesystem::path& path, const Simulation& simulation, const Part& part,
               const Surface& surface);

}  // namespace pliant
