// Texts about the machine and the linked libraries.
#pragma once

#include <string>
#include <vector>

namespace pliant_cli {

/// Returns the instruction sets among sse4.2, avx, avx2, fma and avx512f that the processor has, for example
/// "avx avx2 fma". Returns an empty text on processors other than x86-64.
std::string processor_features();
/// Returns the file names of the BLAS libraries that are loaded into this process, separated by blanks, or
/// "none". The names come from /proc/self/maps, which exists on Linux only.
std::string loaded_blas();
/// Returns the path of an executable file with this name in a folder of PATH; empty if there is none.
std::string find_program(const std::string& name);

/// Returns the text of pliant --version.
std::string version_text();

}  // namespace pliant_cli
