// Wavefront OBJ files: one group a part, vertex normals, colours through a material file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <pliant/io/frame_meshes.h>
#include <pliant/io/run/run_files.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

/// The text of a file with these meshes. Positions in the shortest form that reads back exactly, normals with
/// six decimals. material_file: name of the file with the colours, empty for none.
std::string obj_text(const std::vector<NamedMesh>& meshes, const std::string& material_file = "");
/// The text of the material file: one material a mesh, called like it.
std::string mtl_text(const std::vector<NamedMesh>& meshes);

/// Writes a file (whole or absent). Throws std::system_error.
void write_obj(const std::filesystem::path& path, const std::vector<NamedMesh>& meshes,
               const std::string& material_file = "");
/// The surface of one part of a simulation as it is now; folders of the path are made.
void write_obj(const std::filesystem::path& path, const Simulation& simulation, const Part& part,
               const Surface& surface);

}  // namespace pliant
