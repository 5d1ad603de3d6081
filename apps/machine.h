// What the machine offers and what is linked, in words.
#pragma once

#include <string>
#include <vector>

namespace pliant_cli {

/// Instruction sets of the processor that matter here: "avx avx2 fma"; empty where they are not known.
std::string processor_features();
/// BLAS libraries that are loaded into this process; "none" if there are none.
std::string loaded_blas();
/// Path of a program in PATH; empty if there is none.
std::string find_program(const std::string& name);

/// Text of pliant --version.
std::string version_text();

}  // namespace pliant_cli
