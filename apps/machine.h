// Texts about the machine and the linked libraries.
#pragma once

#include <string>
#include <vector>

namespace pliant_cli {

/// Returns the instruction sets of the processor that the library can use, for example "avx avx2 fma"; empty
/// if unknown.
std::string processor_features();
/// Returns the BLAS libraries that are loaded into this process, or "none".
std::string loaded_blas();
/// Returns the path of a program in PATH; empty if there is none.
std::string find_program(const std::string& name);

/// Returns the text of pliant --version.
std::string version_text();

}  // namespace pliant_cli
